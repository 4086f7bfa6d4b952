// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <system_error>

#include <fmt/format.h>

#include "commands.h"
#include "common/terminal.h"
#include "ydd/base/interruption.h"
#include "ydd/base/version.h"

namespace {

constexpr int kInputFailure = 1;
constexpr int kUsageFailure = 2;
constexpr int kSignalled = 128;  ///< and the signal's number, as a shell tells it

/// A file that is opened later must not become a closed standard stream: log lines would go there.
void reserve_standard_streams() {
  for (int descriptor = 0; descriptor <= 2; ++descriptor) {
    if (::fcntl(descriptor, F_GETFD) != -1 || errno != EBADF) continue;
    if (::open("/dev/null", O_RDWR) < 0)
      std::_Exit(kInputFailure);  // takes the lowest that is free
  }
}

/// What was printed must have arrived; results that go into a pipe are results.
ydd::Result<void> flush_output() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return {};
  return ydd::Error{fmt::format("standard output: cannot be written: {}",
                                std::generic_category().message(errno))};
}

/// Those that look whether they shall end, and do so in good order. The others end at once, as
/// programs do: what they make appears by renaming, or not.
void catch_signals_for(const CLI::App& app) {
  for (const char* const name : {"run", "bench", "detect", "simulate", "convert"}) {
    if (app.got_subcommand(name)) ydd::interruption::catch_signals();
  }
}

int run_job(const ydd::app::Job& job) {
  ydd::Result<void> result = job();
  if (const ydd::Result<void> flushed = flush_output(); !flushed && result) result = flushed;
  if (!result) fmt::print(stderr, "error: {}\n", result.error().message);
  if (const int signal = ydd::interruption::signal(); signal != 0) return kSignalled + signal;
  return result ? EXIT_SUCCESS : kInputFailure;
}

}  // namespace

int main(int argc, char** argv) {
  reserve_standard_streams();
  ydd::interruption::survive_failed_writes();
  CLI::App app{"ydd-slam: visual RGB-D SLAM that keeps its bearings among moving people",
               "ydd-slam"};
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("ydd-slam ") + ydd::kVersion);
  app.fallthrough();  // what the program takes may follow the sub-command
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
  ydd::app::add_convert_command(app, job);
  ydd::app::add_cameras_command(app, job);
  try {
    app.parse(argc, argv);
    catch_signals_for(app);
    return run_job(job);
  } catch (const CLI::ParseError& e) {
    if (app.exit(e) != 0) return kUsageFailure;
    return run_job([]() -> ydd::Result<void> { return {}; });  // help that did not arrive
  } catch (const ydd::interruption::Interrupted& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return kSignalled + ydd::interruption::signal();
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "error: out of memory\n");
    return EXIT_FAILURE;
  } catch (const std::system_error& e) {  // no thread to be had, for example
    fmt::print(stderr, "error: the system refused: {}\n", e.what());
    return EXIT_FAILURE;
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: internal: {}\n", e.what());
    return EXIT_FAILURE;
  }
}
