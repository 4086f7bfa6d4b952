// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace ydd::app {

/// Adds --log-level to the program: how much is logged on standard error.
void add_log_level(CLI::App& app);

/// Adds --quiet: no progress, and no log lines but warnings, unless --log-level says otherwise.
void add_quiet(CLI::App& command, bool& quiet);

/// Adds --map-key: the file with the key of the map files that the command reads and writes.
void add_map_key(CLI::App& command, std::string& file);

}  // namespace ydd::app
