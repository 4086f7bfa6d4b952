// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "commands.h"
#include "ydd/dataset/sequence.h"
#include "ydd/system/system_options.h"

namespace ydd::app {

void add_options_command(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("options", "List every option with default, unit and range");
  command->footer(
      "Example:\n  ydd-slam options > my.yaml && ydd-slam run SEQUENCE --config my.yaml");
  command->callback([&job] {
    job = []() -> Result<void> {
      SystemOptions options;
      OptionTable table;
      options.describe(table);
      SequenceOptions sequence;
      table.group("sequence", sequence);
      fmt::print("{}", table.to_yaml());
      return {};
    };
  });
}

}  // namespace ydd::app
