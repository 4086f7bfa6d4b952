// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/camera_path.h"

#include <gtest/gtest.h>

#include "ydd/simulation/closed_curve.h"
#include "ydd/simulation/room.h"

namespace ydd {
namespace {

TimedPath path(const std::string& name, int rooms = 1) {
  WorldOptions options;
  options.path = parse_choice<PathKind>(name).value();
  options.rooms = rooms;
  return make_camera_path(options);
}

class NamedPath : public testing::TestWithParam<std::string> {};

TEST_P(NamedPath, IsSmoothAndStaysInTheRoom) {
  const TimedPath p = path(GetParam());
  constexpr double kStep_s = 1.0 / 30.0;
  for (double t = 0; t < p.round_s; t += kStep_s) {
    const SE3 before = p.T_world_camera(t - kStep_s);
    const SE3 here = p.T_world_camera(t);
    const SE3 after = p.T_world_camera(t + kStep_s);
    const Eigen::Vector3d at = here.translation();
    EXPECT_GT(at.x(), 0.5);
    EXPECT_LT(at.x(), sim::kRoomWidth_m - 0.5);
    EXPECT_GT(at.y(), 0.5);
    EXPECT_LT(at.y(), 3.8);
    EXPECT_GT(at.z(), 0.9);
    EXPECT_LT(at.z(), 2.4);
    EXPECT_LT((after.translation() - at).norm(), 0.05) << t;  // 1.5 m/s
    EXPECT_LT((here.inverse() * after).angle_rad(), 0.05) << t;
    const SE3 first = before.inverse() * here;
    const SE3 second = here.inverse() * after;
    EXPECT_LT((first.inverse() * second).log().norm(), 0.02) << t;  // no jerks
  }
}

INSTANTIATE_TEST_SUITE_P(All, NamedPath,
                         testing::Values("static", "xyz", "rpy", "halfsphere", "room_loop"));

TEST(CameraPath, StaticHardlyMoves) {
  const TimedPath p = path("static");
  for (double t = 0; t < p.round_s; t += 0.1) {
    const SE3 d = p.T_world_camera(0).inverse() * p.T_world_camera(t);
    EXPECT_LT(d.translation().norm(), 0.02);
    EXPECT_LT(d.angle_rad(), 0.03);
  }
}

TEST(CameraPath, RoomLoopComesBackAndGoesABitFurther) {
  for (const int rooms : {1, 3}) {
    const TimedPath p = path("room_loop", rooms);
    double nearest = 10;
    double nearest_s = 0;
    for (double t = 0.6 * p.round_s; t < p.round_s; t += 1.0 / 30.0) {
      const SE3 d = p.T_world_camera(0).inverse() * p.T_world_camera(t);
      if (d.translation().norm() < nearest) {
        nearest = d.translation().norm();
        nearest_s = t;
      }
    }
    EXPECT_LT(nearest, 0.06);
    EXPECT_LT((p.T_world_camera(0).inverse() * p.T_world_camera(nearest_s)).angle_rad(), 0.1);
    EXPECT_GT(p.round_s - nearest_s, 0.5);
  }
}

TEST(CameraPath, WalksThroughTheDoorsOfAllRooms) {
  const TimedPath p = path("room_loop", 3);
  double farthest = 0;
  for (double t = 0; t < p.round_s; t += 0.1) {
    const Eigen::Vector3d at = p.T_world_camera(t).translation();
    farthest = std::max(farthest, at.x());
    for (int k = 1; k < 3; ++k) {
      if (std::abs(at.x() - (k * sim::kRoomPitch_m - 0.07)) < 0.15) {
        EXPECT_LT(std::abs(at.y() - sim::kDoorMiddle_m), 0.5 * sim::kDoorWidth_m - 0.2);
      }
    }
  }
  EXPECT_GT(farthest, 2 * sim::kRoomPitch_m + 3.0);
}

TEST(LookAt, LooksAtItsTarget) {
  const Eigen::Vector3d target(1, 2, 3);
  const SE3 T = look_at({-1, 0.5, 1}, target);
  const Eigen::Vector3d p = T.inverse() * target;
  EXPECT_NEAR(p.x(), 0, 1e-12);
  EXPECT_NEAR(p.y(), 0, 1e-12);
  EXPECT_GT(p.z(), 0);
  EXPECT_LT((T.rotation() * Eigen::Vector3d::UnitY()).z(), 0);  // y down
}

TEST(ClosedCurve, HasConstantSpeedAndCloses) {
  const sim::ClosedCurve curve({{0, 0}, {2, 0}, {2, 1}, {0, 1}});
  const double length = curve.length_m();
  EXPECT_LT((curve.at(0.3) - curve.at(length + 0.3)).norm(), 1e-9);
  EXPECT_LT((curve.at(-0.2) - curve.at(length - 0.2)).norm(), 1e-9);
  for (double s = 0; s < length; s += 0.05) {
    EXPECT_NEAR((curve.at(s + 0.01) - curve.at(s)).norm(), 0.01, 2e-4);
  }
  EXPECT_THROW(sim::ClosedCurve({{0, 0}, {1, 0}}), std::logic_error);
}

}  // namespace
}  // namespace ydd
