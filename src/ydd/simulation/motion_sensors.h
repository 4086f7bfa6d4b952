// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "ydd/reckoning/motion_samples.h"
#include "ydd/reckoning/reckoning_options.h"

namespace ydd {

/// Senses of motion that the simulated camera carries with it.
struct MotionSensorOptions {
  double imu_hz = 200.0;        ///< 0: none
  double imu_noise = 1.0;       ///< 1: a cheap MEMS sensor's noise and biases
  double odometry_hz = 50.0;    ///< 0: none
  double odometry_slip = 0.01;  ///< of way and turn: standard deviation of the wheels' error
  void describe(OptionTable& table);
};

/// Where they are mounted: as options of those who read them.
ReckoningOptions simulated_mounting();

/// What the sensors say along the path between two times (seconds since the first frame, whose
/// stamp is `start`). The same seed gives the same samples.
MotionSamples sense_motion(const std::function<SE3(double time_s)>& T_world_camera, Timestamp start,
                           double from_s, double until_s, const MotionSensorOptions& options,
                           int seed);

}  // namespace ydd
