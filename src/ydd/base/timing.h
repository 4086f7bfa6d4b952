// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace ydd {

/// Wall clock, monotonic, nanoseconds.
std::int64_t wall_clock_ns();
/// Processor time of the calling thread, nanoseconds: steady on a busy machine.
std::int64_t thread_cpu_ns();

/// How long one stage took for one frame.
struct StageTime {
  std::string stage;     ///< what was done: "orb"
  double wall_ms = 0.0;  ///< from beginning to end, milliseconds
  double cpu_ms = 0.0;   ///< of the thread that ran it
};

/// The stages of one frame in the order in which they ran.
using StageTimes = std::vector<StageTime>;

/// Appends the time from construction to `stop()` (or destruction) to `times`. Destruction does not
/// throw: without memory for it the time is lost.
class StageTimer {
 public:
  /// Measures from now until stop() or its end, then adds to `times`, which must live longer.
  StageTimer(StageTimes& times, std::string stage);
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  void stop();  ///< Ends the measurement now; later calls do nothing.

 private:
  StageTimes* times_;
  std::string stage_;
  std::int64_t wall_start_ns_;
  std::int64_t cpu_start_ns_;
};

/// Median, mean and tails of a series; all zero when it is empty.
struct SeriesStatistics {
  std::size_t count = 0;  ///< length of the series
  /// In the unit of its values; p05: 5 of 100 are smaller.
  double mean = 0, median = 0, p05 = 0, p95 = 0, p99 = 0, min = 0, max = 0;
};
/// In the unit of the values, which may come in any order.
SeriesStatistics statistics_of(std::vector<double> values);

}  // namespace ydd
