// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/base/timestamp.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// Where the camera was: camera frame (x right, y down, z forward) to world, metres.
struct StampedPose {
  Timestamp stamp;     ///< of the frame
  SE3 T_world_camera;  ///< where the camera was
};

/// Poses in the order of time, strictly increasing.
using StampedPoses = std::vector<StampedPose>;

/// Their stamps, in the same order.
std::vector<Timestamp> stamps_of(std::span<const StampedPose> poses);

/// How a trajectory is written to a file.
enum class TrajectoryFormat {
  tum,    ///< "stamp tx ty tz qx qy qz qw", stamp in seconds
  kitti,  ///< first three rows of the 4x4 matrix, row by row; no stamp
  euroc,  ///< "stamp,tx,ty,tz,qw,qx,qy,qz", stamp in nanoseconds
};

/// From "tum", "kitti" or "euroc"; nothing: another name.
std::optional<TrajectoryFormat> parse_trajectory_format(std::string_view name);

/// Reads TUM format, trajectory or ground truth; comments and blank lines are skipped. Failure
/// names file and line: not eight numbers, a quaternion far from unit length, stamps that do not
/// increase, no pose at all.
Result<StampedPoses> read_tum_trajectory(const std::filesystem::path& file);

/// The text of a trajectory file, nine decimals.
std::string format_trajectory(std::span<const StampedPose> poses, TrajectoryFormat format);

/// Writes atomically.
Result<void> write_trajectory(const std::filesystem::path& file, std::span<const StampedPose> poses,
                              TrajectoryFormat format = TrajectoryFormat::tum);

}  // namespace ydd
