// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/base/timestamp.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// One reading of gyroscope and accelerometer, in the frame of the sensor.
struct ImuSample {
  Timestamp stamp;  ///< when it was read, by the clock of the pictures
  Eigen::Vector3d gyro_rad_s = Eigen::Vector3d::Zero();  ///< rate of turn about the sensor's axes
  Eigen::Vector3d accel_m_s2 = Eigen::Vector3d::Zero();  ///< what it feels: at rest g upwards
};

/// One reading of wheel odometry, or of whatever else adds up its own motion: where the base is in
/// a frame that drifts.
struct OdometryPose {
  Timestamp stamp;  ///< by the clock of the pictures
  SE3 T_odom_base;  ///< from the base's frame to that of the odometry, metres
};

/// What the motion sensors of a recording said, each in the order of time.
struct MotionSamples {
  std::vector<ImuSample> imu;          ///< readings of one IMU
  std::vector<OdometryPose> odometry;  ///< poses of one odometry
  /// Whether neither said anything.
  bool empty() const { return imu.empty() && odometry.empty(); }
};

}  // namespace ydd
