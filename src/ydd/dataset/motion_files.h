// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/reckoning/motion_samples.h"

namespace ydd {

/// Reads what an IMU said: a line for each sample with its stamp, three turn rates in rad/s and
/// three accelerations in m/s^2, in the sensor's frame; by the names of a header (EuRoC's "w_RS_S_x
/// [rad s^-1]", "a_RS_S_x [m s^-2]", or wx, gyro_x, ax, accel_x, ...) or in this order. Failure
/// names file and line: no number, a stamp that does not increase, values that no such sensor gives
/// (more than 100 rad/s or 500 m/s^2: degrees, or g?), no sample at all.
Result<std::vector<ImuSample>> read_imu_file(const std::filesystem::path& file);

/// Reads odometry: any trajectory file that `read_tum_trajectory` reads, of T_odom_base.
Result<std::vector<OdometryPose>> read_odometry_file(const std::filesystem::path& file);

/// The text of such files, with headers; nine decimals.
std::string format_imu(const std::vector<ImuSample>& samples);
std::string format_odometry(const std::vector<OdometryPose>& poses);

}  // namespace ydd
