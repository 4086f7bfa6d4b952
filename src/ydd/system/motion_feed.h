// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "ydd/system/slam_system.h"

namespace ydd {

/// Gives recorded motion samples to the system as they would have come: each before the first frame
/// that is not earlier.
class MotionFeed {
 public:
  explicit MotionFeed(MotionSamples samples) : samples_(std::move(samples)) {}

  /// Hands over what has come until `stamp`.
  void until(Timestamp stamp, SlamSystem& system) {
    imu_ = hand_over(samples_.imu, imu_, stamp, system);
    odometry_ = hand_over(samples_.odometry, odometry_, stamp, system);
  }

 private:
  template <class Sample>
  static std::size_t hand_over(const std::vector<Sample>& samples, std::size_t next,
                               Timestamp stamp, SlamSystem& system) {
    for (; next < samples.size() && samples[next].stamp <= stamp; ++next) system.add(samples[next]);
    return next;
  }

  MotionSamples samples_;
  std::size_t imu_ = 0, odometry_ = 0;  ///< that come next
};

}  // namespace ydd
