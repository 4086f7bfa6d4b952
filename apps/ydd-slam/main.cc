// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <exception>

#include <fmt/format.h>

#include "commands.h"
#include "terminal.h"
#include "ydd/base/version.h"

namespace {

constexpr int kInputFailure = 1;
constexpr int kUsageFailure = 2;

int run_job(const ydd::app::Job& job) {
  if (const ydd::Result<void> result = job(); !result) {
    fmt::print(stderr, "error: {}\n", result.error().message);
    return kInputFailure;
  }
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"ydd-slam: visual RGB-D SLAM that keeps its bearings among moving people",
               "ydd-slam"};
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("ydd-slam ") + ydd::kVersion);
  app.fallthrough();  // what the programme takes may follow the sub-command
  ydd::app::add_log_level(app);
  ydd::app::Job job;
  ydd::app::add_run_command(app, job);
  ydd::app::add_bench_command(app, job);
  ydd::app::add_options_command(app, job);
  ydd::app::add_eval_command(app, job);
  ydd::app::add_report_command(app, job);
  ydd::app::add_map_command(app, job);
  ydd::app::add_detect_command(app, job);
  ydd::app::add_simulate_command(app, job);
  try {
    app.parse(argc, argv);
    return run_job(job);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? EXIT_SUCCESS : kUsageFailure;
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: internal: {}\n", e.what());
    return EXIT_FAILURE;
  }
}
