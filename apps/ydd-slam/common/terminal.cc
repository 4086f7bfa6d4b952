// SPDX-License-Identifier: Apache-2.0
#include "common/terminal.h"

#include <map>
#include <string>

#include "ydd/base/log.h"

namespace ydd::app {
namespace {

const std::map<std::string, log::Level>& levels() {
  static const std::map<std::string, log::Level> by_name = {{"debug", log::Level::debug},
                                                            {"info", log::Level::info},
                                                            {"warning", log::Level::warning},
                                                            {"error", log::Level::error},
                                                            {"off", log::Level::off}};
  return by_name;
}

}  // namespace

void add_log_level(CLI::App& app) {
  app.add_option_function<std::string>(
         "--log-level", [](const std::string& name) { log::set_level(levels().at(name)); },
         "How much is logged on standard error: debug, info, warning, error or off")
      ->check(CLI::IsMember(levels()))
      ->default_str("info");
}

void add_quiet(CLI::App& command, bool& quiet) {
  command.add_flag_callback(
      "--quiet",
      [&quiet] {
        quiet = true;  // --log-level has been looked at by now
        const bool untouched = log::enabled(log::Level::info) && !log::enabled(log::Level::debug);
        if (untouched) log::set_level(log::Level::warning);
      },
      "Only warnings and errors, no progress");
}

void add_map_key(CLI::App& command, std::string& file) {
  command.add_option("--map-key", file,
                     "File with the key that map files are encrypted by (default: the one that "
                     "YDD_MAP_KEY_FILE names, else they are plain; docs/privacy.md)");
}

}  // namespace ydd::app
