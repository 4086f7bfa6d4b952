// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <exception>
#include <string>

namespace ydd {

/// Being asked to end by SIGINT (Ctrl-C), SIGTERM or SIGHUP (the terminal is gone).
///
/// The first such signal is remembered, and whoever computes for long looks here and ends in good
/// order; a second one, a quarter of a second later or more, ends the process at once. Thread: any,
/// for every function.
namespace interruption {

/// From now on signals are remembered, so that somebody must look. One that is ignored already
/// (`nohup`) stays ignored.
void catch_signals();

/// A broken pipe, or a file that may not grow, becomes an error of the write that meets it instead
/// of the end of the process.
void survive_failed_writes();

/// The signal that asked; 0: none.
int signal();

/// Its name, "SIGINT"; empty: none.
std::string signal_name();

/// What throw_if_asked() throws; what() is one line for the user.
class Interrupted : public std::exception {
 public:
  Interrupted();
  const char* what() const noexcept override { return what_.c_str(); }

 private:
  std::string what_;
};

/// For work that is worth nothing when it is cut short: leaves it by an exception once a signal
/// asked to end, so that temporary files go. What was finished before stays.
void throw_if_asked();

/// All was done before the signal cut anything short: the program ends as if none had come.
void forgive();

/// Sleeps until `when`, or until a signal asks to end. False when one did.
bool sleep_until(std::chrono::steady_clock::time_point when);

}  // namespace interruption
}  // namespace ydd
