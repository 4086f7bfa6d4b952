// SPDX-License-Identifier: Apache-2.0
#include "ydd/reckoning/reckoning_options.h"

#include <array>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

namespace ydd {

void ReckoningOptions::describe(OptionTable& t) {
  t.add("T_camera_imu", T_camera_imu, {},
        "where the IMU is, tx ty tz qx qy qz qw: IMU frame to camera frame, metres");
  t.add("T_camera_base", T_camera_base, {},
        "where what the odometry tells of is, tx ty tz qx qy qz qw: base frame to camera frame");
  t.add("longest_s", longest_s, {0.0, 3600.0}, "s",
        "the pose goes on by odometry for so long without a view; then the camera is lost");
  t.add("longest_imu_s", longest_imu_s, {0.0, 60.0}, "s", "the same by the IMU alone");
  t.add("odometry_drift_share", odometry_drift_share, {0.0, 1.0}, "",
        "standard deviation of odometry, of the distance gone");
  t.add("accel_sigma_m_s2", accel_sigma_m_s2, {0.0, 10.0}, "m/s^2",
        "standard deviation of what is left of the accelerometer's bias and of gravity");
  t.add("gyro_sigma_rad_s", gyro_sigma_rad_s, {0.0, 1.0}, "rad/s",
        "standard deviation of what is left of the gyroscope's bias");
}

Result<SE3> parse_mounting(std::string_view text, std::string_view key) {
  std::istringstream in{std::string(text)};
  std::array<double, 7> n{};
  bool good = true;
  for (double& number : n) good = good && (in >> number) && std::isfinite(number);
  std::string rest;
  const Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
  if (!good || (in >> rest) || std::abs(q.norm() - 1.0) > 0.01) {
    return Error{fmt::format(
        "{}: \"{}\" is no mounting: give tx ty tz in metres and a unit quaternion qx qy qz qw", key,
        text)};
  }
  return SE3(q, {n[0], n[1], n[2]});
}

Result<void> check(const ReckoningOptions& options) {
  if (auto r = parse_mounting(options.T_camera_imu, "reckoning.T_camera_imu"); !r) return r.error();
  if (auto r = parse_mounting(options.T_camera_base, "reckoning.T_camera_base"); !r) {
    return r.error();
  }
  return {};
}

}  // namespace ydd
