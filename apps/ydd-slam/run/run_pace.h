// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "ydd/dataset/sequence.h"

namespace ydd::app {

/// Seconds from one frame to the next, by their stamps; 0 with fewer than two frames.
double median_gap_s(const Sequence& sequence);

/// What is odd about the times of the frames, one line each: gaps that no camera makes, and a
/// spacing that tells of another unit than seconds. `fps` is the camera's.
std::vector<std::string> odd_stamps(const Sequence& sequence, double fps);

/// Real-time pace: which frame is due, and waiting for it. Gaps that no camera makes are not slept
/// through: the frame after one is due as if the camera had gone on.
class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  Pace(const Sequence& sequence, double fps);

  /// The newest frame that a live camera would have delivered by now, at least `i`.
  std::size_t newest_due(std::size_t i) const;
  /// False when a signal asks to end meanwhile.
  bool wait_until_due(std::size_t i) const;
  /// The camera, too, stood still for so long.
  void postpone(Clock::duration pause) { start_ += pause; }

 private:
  std::vector<Clock::duration> due_;  ///< after the start, by frame
  Clock::time_point start_;
};

}  // namespace ydd::app
