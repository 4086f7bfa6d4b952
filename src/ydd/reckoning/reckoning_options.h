// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ydd/base/options.h"
#include "ydd/base/result.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// How motion sensors are mounted, how good they are, and how far they are believed.
struct ReckoningOptions {
  std::string T_camera_imu = "0 0 0 0 0 0 1";   ///< "tx ty tz qx qy qz qw", metres
  std::string T_camera_base = "0 0 0 0 0 0 1";  ///< of the frame whose odometry is given
  double longest_s = 10.0;             ///< without a view, by wheels; then the camera is lost
  double longest_imu_s = 6.0;          ///< the same by inertia alone
  double odometry_drift_share = 0.03;  ///< standard deviation, of the distance
  double accel_sigma_m_s2 = 0.05;      ///< of what is left of bias and tilt
  double gyro_sigma_rad_s = 0.002;
  void describe(OptionTable& table);
};

/// The motion that "tx ty tz qx qy qz qw" means. Failure names the key.
Result<SE3> parse_mounting(std::string_view text, std::string_view key);

/// Fails with one line that names the key unless all mountings can be read.
Result<void> check(const ReckoningOptions& options);

}  // namespace ydd
