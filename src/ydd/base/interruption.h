// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace ydd {

/// Being asked to end by SIGINT (Ctrl-C), SIGTERM or SIGHUP (the terminal is gone).
///
/// The first such signal is remembered, and whoever computes for long looks here and ends in good
/// order; a second one, a quarter of a second later or more, ends the process at once. Thread: any,
/// for every function.
namespace interruption {

/// From now on signals are remembered. One that is ignored already (`nohup`) stays ignored; a
/// broken pipe becomes an error of the write that meets it instead of the end of the process.
void catch_signals();

/// The signal that asked; 0: none.
int signal();

/// Its name, "SIGINT"; empty: none.
std::string signal_name();

/// All was done before the signal cut anything short: the program ends as if none had come.
void forgive();

/// Sleeps until `when`, or until a signal asks to end. False when one did.
bool sleep_until(std::chrono::steady_clock::time_point when);

}  // namespace interruption
}  // namespace ydd
