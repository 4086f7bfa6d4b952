// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "ydd/base/result.h"

namespace ydd::app {

/// A sub-command adds itself to the command line and sets `job` in its callback; main() runs the
/// job after parsing, prints a failure as one line and exits 1.
using Job = std::function<Result<void>()>;

void add_run_command(CLI::App& app, Job& job);
void add_bench_command(CLI::App& app, Job& job);
void add_options_command(CLI::App& app, Job& job);
void add_eval_command(CLI::App& app, Job& job);
void add_report_command(CLI::App& app, Job& job);
void add_detect_command(CLI::App& app, Job& job);
void add_map_command(CLI::App& app, Job& job);
void add_cameras_command(CLI::App& app, Job& job);
void add_convert_command(CLI::App& app, Job& job);
void add_simulate_command(CLI::App& app, Job& job);

}  // namespace ydd::app
