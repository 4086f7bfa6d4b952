// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/base/timestamp.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// One reading of gyroscope and accelerometer, in the frame of the sensor.
struct ImuSample {
  Timestamp stamp;
  Eigen::Vector3d gyro_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_m_s2 = Eigen::Vector3d::Zero();  ///< what it feels: at rest g upwards
};

/// One reading of wheel odometry, or of whatever else adds up its own motion: where the base is in
/// a frame that drifts.
struct OdometryPose {
  Timestamp stamp;
  SE3 T_odom_base;
};

/// What the motion sensors of a recording said, each in the order of time.
struct MotionSamples {
  std::vector<ImuSample> imu;
  std::vector<OdometryPose> odometry;
  bool empty() const { return imu.empty() && odometry.empty(); }
};

}  // namespace ydd
