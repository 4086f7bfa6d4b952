// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"

/// The binary as its users meet it, for the end-to-end tests.
namespace ydd::e2e {

namespace fs = std::filesystem;

/// Sanitized programs are ten times slower: tests then use fewer frames and judge no accuracy.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// Runs look at their frames only where a test says with what.
inline const int kNoDetectorByDefault =
    ::setenv("YDD_DETECTOR", "none", 0);  // NOLINT(concurrency-mt-unsafe): before main

/// What a call of the binary left.
struct Outcome {
  int exit_code = -1;  ///< 128 + signal when it was killed
  std::string out;     ///< standard output
  std::string err;     ///< standard error

  /// Lines of standard error that begin with "error:".
  std::vector<std::string> error_lines() const {
    std::vector<std::string> lines;
    for (std::size_t start = 0; start < err.size();) {
      const std::size_t end = std::min(err.find('\n', start), err.size());
      const std::string line = err.substr(start, end - start);
      if (line.starts_with("error:")) lines.push_back(line);
      start = end + 1;
    }
    return lines;
  }
  std::size_t lines_on_err() const {
    return static_cast<std::size_t>(std::count(err.begin(), err.end(), '\n'));
  }
};

/// Runs a program (found on the PATH) with its arguments in `folder` (default: here) and waits
/// for it.
inline Outcome run_program(std::vector<std::string> arguments, const fs::path& folder = ".") {
  const TemporaryFolder scratch;
  const std::string out_file = scratch / "out";
  const std::string err_file = scratch / "err";
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    // Between fork and exec only what is safe after a fork.
    const int out = ::open(out_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int err = ::open(err_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (out < 0 || err < 0 || ::dup2(out, STDOUT_FILENO) < 0 || ::dup2(err, STDERR_FILENO) < 0 ||
        ::chdir(folder.c_str()) != 0) {
      ::_exit(126);
    }
    ::execvp(argv.front(), argv.data());
    ::_exit(127);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  Outcome outcome;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = read_file(out_file).value();
  outcome.err = read_file(err_file).value();
  return outcome;
}

/// Runs `ydd-slam ARGUMENTS...` in `folder` (default: here) and waits for it.
inline Outcome ydd_slam(std::vector<std::string> arguments, const fs::path& folder = ".") {
  arguments.insert(arguments.begin(), YDD_BINARY);
  return run_program(std::move(arguments), folder);
}

}  // namespace ydd::e2e
