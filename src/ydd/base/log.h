// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

/// Log lines go to standard error. Libraries log; only the application prints.
namespace ydd::log {

/// How much a line matters; `off` drops all.
enum class Level { debug, info, warning, error, off };

/// Lines below `level` are dropped. Default: info.
void set_level(Level level);
bool enabled(Level level);  ///< Whether a line of this level is written.
/// While a line without its line break stands on the terminal (progress), log lines replace it.
void set_over_open_line(bool open);
/// One line to standard error, with its level before it. Any thread.
void write(Level level, std::string_view line);

/// For who works on the program.
template <class... Args>
void debug(fmt::format_string<Args...> format, Args&&... args) {
  if (enabled(Level::debug)) write(Level::debug, fmt::format(format, std::forward<Args>(args)...));
}
/// What is good to know.
template <class... Args>
void info(fmt::format_string<Args...> format, Args&&... args) {
  if (enabled(Level::info)) write(Level::info, fmt::format(format, std::forward<Args>(args)...));
}
/// What was not as it should be, and the work goes on.
template <class... Args>
void warning(fmt::format_string<Args...> format, Args&&... args) {
  if (enabled(Level::warning)) {
    write(Level::warning, fmt::format(format, std::forward<Args>(args)...));
  }
}

}  // namespace ydd::log
