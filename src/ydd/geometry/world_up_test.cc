// SPDX-License-Identifier: Apache-2.0
#include "ydd/geometry/world_up.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

/// A camera turned round by `yaw` and then tilted down by `pitch`, in a world that lies askew.
SE3 pose(double yaw_rad, double pitch_rad, const Eigen::Quaterniond& askew) {
  const Eigen::Quaterniond turn(AngleAxisd(yaw_rad, Vector3d::UnitY()));
  const Eigen::Quaterniond tilt(AngleAxisd(-pitch_rad, Vector3d::UnitX()));
  return {askew * turn * tilt, Vector3d::Zero()};
}

TEST(WorldUp, IsFoundForATiltedCameraThatTurnsRound) {
  const Eigen::Quaterniond askew(AngleAxisd(0.6, Vector3d(1, 0.2, -0.4).normalized()));
  std::vector<SE3> poses;
  for (int i = 0; i < 12; ++i) poses.push_back(pose(0.5 * i, 0.45, askew));
  EXPECT_GT(world_up(poses).dot(askew * Vector3d(0, -1, 0)), 0.999);
}

TEST(WorldUp, WithoutTurningItIsThatOfTheCamera) {
  const std::vector<SE3> poses(5, SE3{});
  EXPECT_GT(world_up(poses).dot(Vector3d(0, -1, 0)), 0.999);
}

TEST(WorldUp, ALittleTurningStillHelps) {
  std::vector<SE3> poses;
  for (int i = -5; i <= 5; ++i)
    poses.push_back(pose(0.12 * i, 0.5, Eigen::Quaterniond::Identity()));
  const double mean_only = std::cos(0.5);
  EXPECT_GT(world_up(poses).dot(Vector3d(0, -1, 0)), mean_only);
}

TEST(WorldUp, WithoutAPoseItIsTheFirstCameras) { EXPECT_EQ(world_up({}), Vector3d(0, -1, 0)); }

}  // namespace
}  // namespace ydd
