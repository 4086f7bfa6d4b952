// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/trajectory.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "ydd/base/files.h"
#include "ydd/dataset/text_table.h"

namespace ydd {
namespace {

constexpr std::size_t kNumbers = 7;  // of a pose

/// Where a row, which begins with the time, has tx ty tz qx qy qz qw.
struct PoseColumns {
  std::array<std::size_t, kNumbers> numbers{1, 2, 3, 4, 5, 6, 7};
  std::size_t fields = kNumbers + 1;  ///< that a row has
};

/// By the names of the header where it has them all, else by the order of the format: TUM's, or
/// EuRoC's (qw first) for whole nanoseconds between commas.
PoseColumns pose_columns(const TextTable& table) {
  PoseColumns out;
  const std::array<std::optional<std::size_t>, kNumbers> named = {
      find_column(table, {"tx", "p_x", "px", "x"}),
      find_column(table, {"ty", "p_y", "py", "y"}),
      find_column(table, {"tz", "p_z", "pz", "z"}),
      find_column(table, {"qx", "q_x"}),
      find_column(table, {"qy", "q_y"}),
      find_column(table, {"qz", "q_z"}),
      find_column(table, {"qw", "q_w"})};
  if (std::all_of(named.begin(), named.end(), [](const auto& column) { return column; })) {
    for (std::size_t i = 0; i < kNumbers; ++i) out.numbers[i] = *named[i];
    out.fields = table.columns.size();
    return out;
  }
  constexpr std::size_t kNanosecondDigits = 17;
  // Not ?: between "" and the field: that would make a text of its own, and look at it after its
  // end.
  const std::string first = table.rows.empty() ? "" : table.rows.front().fields.front();
  if (table.commas && first.size() >= kNanosecondDigits &&
      first.find('.') == std::string_view::npos) {
    out.numbers = {1, 2, 3, 5, 6, 7, 4};
  }
  return out;
}

Result<std::array<double, kNumbers>> parse_numbers(const std::filesystem::path& file,
                                                   const TextRow& row, const PoseColumns& columns) {
  std::array<double, kNumbers> numbers{};
  for (std::size_t i = 0; i < kNumbers; ++i) {
    std::string_view text = row.fields[columns.numbers[i]];
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), numbers[i]);
    const bool is_number = code == std::errc() && end == text.data() + text.size();
    if (!is_number || !std::isfinite(numbers[i])) {
      return row_error(file, row,
                       fmt::format("'{}' is not a number", row.fields[columns.numbers[i]]));
    }
  }
  return numbers;
}

Result<SE3> parse_pose(const std::filesystem::path& file, const TextRow& row,
                       const PoseColumns& columns) {
  if (row.fields.size() != columns.fields) {
    return row_error(file, row, "expected 'timestamp tx ty tz qx qy qz qw', found " + quoted(row));
  }
  const auto n = parse_numbers(file, row, columns);
  if (!n) return n.error();
  const Eigen::Quaterniond q((*n)[6], (*n)[3], (*n)[4], (*n)[5]);
  constexpr double kRounding = 0.01;  // ground truth has four decimals
  if (std::abs(q.norm() - 1.0) > kRounding) {
    return row_error(file, row, fmt::format("the quaternion has length {:.4f}, not 1", q.norm()));
  }
  return SE3(q, {(*n)[0], (*n)[1], (*n)[2]});
}

/// q and -q are the same rotation: write the one with w >= 0.
Eigen::Quaterniond canonical(const Eigen::Quaterniond& q) {
  return q.w() < 0 ? Eigen::Quaterniond(-q.coeffs()) : q;
}

std::string format_pose(const StampedPose& pose, TrajectoryFormat format) {
  const Eigen::Vector3d& t = pose.T_world_camera.translation();
  const Eigen::Quaterniond q = canonical(pose.T_world_camera.rotation());
  switch (format) {
    case TrajectoryFormat::tum:
      return fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n",
                         format_timestamp(pose.stamp), t.x(), t.y(), t.z(), q.x(), q.y(), q.z(),
                         q.w());
    case TrajectoryFormat::kitti: {
      const Eigen::Matrix3d r = q.toRotationMatrix();
      std::string line;
      for (int i = 0; i < 3; ++i) {
        fmt::format_to(std::back_inserter(line), "{:.9f} {:.9f} {:.9f} {:.9f}{}", r(i, 0), r(i, 1),
                       r(i, 2), t(i), i < 2 ? ' ' : '\n');
      }
      return line;
    }
    case TrajectoryFormat::euroc:
      return fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n", pose.stamp.ns,
                         t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z());
  }
  return "";
}

}  // namespace

std::vector<Timestamp> stamps_of(std::span<const StampedPose> poses) {
  std::vector<Timestamp> stamps;
  stamps.reserve(poses.size());
  for (const StampedPose& pose : poses) stamps.push_back(pose.stamp);
  return stamps;
}

std::optional<TrajectoryFormat> parse_trajectory_format(std::string_view name) {
  if (name == "tum") return TrajectoryFormat::tum;
  if (name == "kitti") return TrajectoryFormat::kitti;
  if (name == "euroc") return TrajectoryFormat::euroc;
  return std::nullopt;
}

Result<StampedPoses> read_tum_trajectory(const std::filesystem::path& file) {
  const Result<TextTable> table = read_text_table(file);
  if (!table) return table.error();
  const PoseColumns columns = pose_columns(*table);
  StampedPoses poses;
  poses.reserve(table->rows.size());
  for (const TextRow& row : table->rows) {
    const auto pose = parse_pose(file, row, columns);
    if (!pose) return pose.error();
    const auto stamp = row_stamp(file, *table, row, poses.empty() ? nullptr : &poses.back().stamp);
    if (!stamp) return stamp.error();
    poses.push_back({*stamp, *pose});
  }
  if (poses.empty()) return Error{fmt::format("{}: holds no pose", file.string())};
  return poses;
}

std::string format_trajectory(std::span<const StampedPose> poses, TrajectoryFormat format) {
  std::string text;
  if (format == TrajectoryFormat::euroc) {
    text = "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z []\n";
  }
  for (const StampedPose& pose : poses) text += format_pose(pose, format);
  return text;
}

Result<void> write_trajectory(const std::filesystem::path& file, std::span<const StampedPose> poses,
                              TrajectoryFormat format) {
  return write_file_atomically(file, format_trajectory(poses, format));
}

}  // namespace ydd
