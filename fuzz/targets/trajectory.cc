// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/trajectory.h"
#include "support.h"
#include "targets.h"

namespace ydd::fuzz {

void trajectory(std::string_view input) {
  const auto poses = read_tum_trajectory(file_of(input, "trajectory.txt"));
  expect_one_line(poses);
  if (!poses) return;
  for (const StampedPose& pose : *poses) {
    const SE3& T = pose.T_world_camera;
    if (!T.translation().allFinite() || std::abs(T.rotation().norm() - 1.0) > 1e-9) {
      broken("a pose that is no rigid motion");
    }
  }
  for (const auto format :
       {TrajectoryFormat::tum, TrajectoryFormat::kitti, TrajectoryFormat::euroc}) {
    const std::string text = format_trajectory(*poses, format);
    if (format != TrajectoryFormat::tum) continue;
    const auto again = read_tum_trajectory(file_of(text, "again.txt"));
    if (!again) broken("not read again: " + again.error().message);
    if (again->size() != poses->size()) broken("read again otherwise");
  }
}

}  // namespace ydd::fuzz
