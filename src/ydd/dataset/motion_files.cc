// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/motion_files.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "ydd/dataset/text_table.h"
#include "ydd/dataset/trajectory.h"

namespace ydd {
namespace {

constexpr std::size_t kReadings = 6;  // of a sample: turn rates, accelerations
constexpr double kMostTurn_rad_s = 100.0, kMostAccel_m_s2 = 500.0;

/// Where a row has its readings.
std::array<std::size_t, kReadings> reading_columns(const TextTable& table) {
  const std::array<std::optional<std::size_t>, kReadings> named = {
      find_column(table, {"w_rs_s_x", "wx", "gx", "gyro_x", "angular_velocity_x"}),
      find_column(table, {"w_rs_s_y", "wy", "gy", "gyro_y", "angular_velocity_y"}),
      find_column(table, {"w_rs_s_z", "wz", "gz", "gyro_z", "angular_velocity_z"}),
      find_column(table, {"a_rs_s_x", "ax", "accel_x", "linear_acceleration_x"}),
      find_column(table, {"a_rs_s_y", "ay", "accel_y", "linear_acceleration_y"}),
      find_column(table, {"a_rs_s_z", "az", "accel_z", "linear_acceleration_z"})};
  std::array<std::size_t, kReadings> out{1, 2, 3, 4, 5, 6};
  if (std::all_of(named.begin(), named.end(), [](const auto& c) { return c.has_value(); })) {
    for (std::size_t i = 0; i < kReadings; ++i) out[i] = *named[i];
  }
  return out;
}

Result<double> reading(const std::filesystem::path& file, const TextRow& row, std::size_t field,
                       double most, const char* unit) {
  if (field >= row.fields.size()) {
    return row_error(file, row,
                     "expected 'timestamp wx wy wz ax ay az' (rad/s, m/s^2), found " + quoted(row));
  }
  std::string_view text = row.fields[field];
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return row_error(file, row, fmt::format("'{}' is not a number", row.fields[field]));
  }
  if (std::abs(value) > most) {
    return row_error(file, row,
                     fmt::format("{} is more than any sensor of {} gives; is it another unit?",
                                 row.fields[field], unit));
  }
  return value;
}

}  // namespace

Result<std::vector<ImuSample>> read_imu_file(const std::filesystem::path& file) {
  const Result<TextTable> table = read_text_table(file);
  if (!table) return table.error();
  const std::array<std::size_t, kReadings> columns = reading_columns(*table);
  std::vector<ImuSample> samples;
  samples.reserve(table->rows.size());
  for (const TextRow& row : table->rows) {
    ImuSample sample;
    const auto stamp =
        row_stamp(file, *table, row, samples.empty() ? nullptr : &samples.back().stamp);
    if (!stamp) return stamp.error();
    sample.stamp = *stamp;
    for (std::size_t i = 0; i < kReadings; ++i) {
      const bool turns = i < 3;
      const Result<double> value =
          reading(file, row, columns[i], turns ? kMostTurn_rad_s : kMostAccel_m_s2,
                  turns ? "rad/s" : "m/s^2");
      if (!value) return value.error();
      (turns ? sample.gyro_rad_s : sample.accel_m_s2)[static_cast<Eigen::Index>(i % 3)] = *value;
    }
    samples.push_back(sample);
  }
  if (samples.empty()) return Error{file.string() + ": has no sample of an IMU"};
  return samples;
}

Result<std::vector<OdometryPose>> read_odometry_file(const std::filesystem::path& file) {
  const Result<StampedPoses> poses = read_tum_trajectory(file);
  if (!poses) return poses.error();
  std::vector<OdometryPose> out;
  out.reserve(poses->size());
  for (const StampedPose& pose : *poses) out.push_back({pose.stamp, pose.T_world_camera});
  return out;
}

std::string format_imu(const std::vector<ImuSample>& samples) {
  std::string text =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  for (const ImuSample& s : samples) {
    fmt::format_to(std::back_inserter(text), "{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n",
                   s.stamp.ns, s.gyro_rad_s.x(), s.gyro_rad_s.y(), s.gyro_rad_s.z(),
                   s.accel_m_s2.x(), s.accel_m_s2.y(), s.accel_m_s2.z());
  }
  return text;
}

std::string format_odometry(const std::vector<OdometryPose>& poses) {
  StampedPoses stamped;
  stamped.reserve(poses.size());
  for (const OdometryPose& pose : poses) stamped.push_back({pose.stamp, pose.T_odom_base});
  return "# odometry: timestamp tx ty tz qx qy qz qw of the base\n" +
         format_trajectory(stamped, TrajectoryFormat::tum);
}

}  // namespace ydd
