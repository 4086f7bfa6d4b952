// SPDX-License-Identifier: Apache-2.0
#include "ydd/viewer/orbit_camera.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace ydd {
namespace {

using Eigen::Vector3d;

/// Where a point is drawn: x right, y up, both -1..1 inside the view; z > 1 or < -1: clipped.
Vector3d drawn(const OrbitCamera& camera, const Vector3d& p_world, double aspect = 1) {
  const Eigen::Vector4d clip =
      camera.projection(aspect) * camera.T_eye_world() * p_world.homogeneous();
  return clip.head<3>() / clip.w();
}

TEST(OrbitCamera, TheTargetIsInTheMiddleWhateverIsTurned) {
  OrbitCamera camera;
  camera.look_at({1, 2, 3});
  for (int i = 0; i < 20; ++i) {
    camera.orbit(37 * i, 11 * i - 70);
    camera.zoom(i % 3 - 1);
    const Vector3d p = drawn(camera, {1, 2, 3});
    EXPECT_NEAR(p.x(), 0, 1e-9);
    EXPECT_NEAR(p.y(), 0, 1e-9);
    EXPECT_LT(std::abs(p.z()), 1);
    EXPECT_NEAR((camera.eye() - camera.target()).norm(), camera.distance_m(), 1e-9);
  }
}

TEST(OrbitCamera, AtFirstItLooksAsTheFirstCameraDid) {
  OrbitCamera camera;
  camera.set_angles(0, 0);
  EXPECT_LT((camera.eye() - Vector3d(0, 0, -3)).norm(), 1e-9);  // behind, looking along z
  EXPECT_GT(drawn(camera, {0.5, 0, 0}).x(), 0.1);               // x is to the right
  EXPECT_LT(drawn(camera, {0, 0.5, 0}).y(), -0.1);              // y is down
}

TEST(OrbitCamera, IsARigidMotion) {
  OrbitCamera camera;
  camera.set_up({0.2, -0.9, 0.3});
  camera.orbit(123, 45);
  const Eigen::Matrix3d r = camera.T_eye_world().topLeftCorner<3, 3>();
  EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(r.determinant(), 1, 1e-12);
}

TEST(OrbitCamera, UpIsUpOnTheScreen) {
  for (const Vector3d& up : {Vector3d(0, -1, 0), Vector3d(0, 0, 1), Vector3d(0.5, -0.5, 0.7)}) {
    OrbitCamera camera;
    camera.set_up(up);
    camera.orbit(200, -50);
    const Vector3d p = drawn(camera, 0.3 * up.normalized());
    EXPECT_NEAR(p.x(), 0, 1e-9);
    EXPECT_GT(p.y(), 0.05);
  }
}

TEST(OrbitCamera, DragsDoWhatTheHandExpects) {
  OrbitCamera camera;
  camera.set_angles(0, 0.3);
  const double pitch_rad = camera.pitch_rad();
  camera.orbit(0, 50);  // pulled down: seen from further above
  EXPECT_GT(camera.pitch_rad(), pitch_rad);
  camera.set_angles(0, 0);
  camera.orbit(50, 0);  // pulled to the right: what is near moves to the right
  EXPECT_GT(drawn(camera, {0, 0, -1}).x(), 0.05);
}

TEST(OrbitCamera, NeverTurnsOverHead) {
  OrbitCamera camera;
  camera.orbit(0, 1e6);
  EXPECT_LT(camera.pitch_rad(), std::numbers::pi / 2);
  EXPECT_GT(drawn(camera, {0, -0.5, 0}).y(), 0);
  camera.orbit(0, -1e6);
  EXPECT_GT(camera.pitch_rad(), -std::numbers::pi / 2);
}

TEST(OrbitCamera, PanKeepsThePointUnderTheMouse) {
  OrbitCamera camera;
  camera.set_angles(0.7, 0.4);
  const double height_px = 600;
  const Vector3d before = drawn(camera, Vector3d::Zero());
  camera.pan(60, -30, height_px);
  const Vector3d after = drawn(camera, Vector3d::Zero());
  EXPECT_NEAR((after - before).x() * height_px / 2, 60, 1e-6);
  EXPECT_NEAR((after - before).y() * height_px / 2, 30, 1e-6);
}

TEST(OrbitCamera, ZoomStaysWithinBounds) {
  OrbitCamera camera;
  camera.zoom(1);
  EXPECT_NEAR(camera.distance_m(), 2.7, 1e-9);
  camera.zoom(1000);
  EXPECT_GT(camera.distance_m(), 0.01);
  camera.zoom(-1000);
  EXPECT_LT(camera.distance_m(), 1e4);
}

TEST(OrbitCamera, FitSeesAllOfTheBall) {
  OrbitCamera camera;
  camera.orbit(77, 13);
  camera.fit({1, -1, 4}, 2);
  for (const Vector3d& d : {Vector3d(2, 0, 0), Vector3d(0, 2, 0), Vector3d(0, 0, -2)}) {
    const Vector3d p = drawn(camera, Vector3d(1, -1, 4) + d);
    EXPECT_LE(p.cwiseAbs().maxCoeff(), 1.0 + 1e-9);
  }
}

TEST(OrbitCamera, ApproachesWithoutOvershooting) {
  OrbitCamera camera;
  const Vector3d target(3, 0, 0);
  double left_m = 3;
  for (int i = 0; i < 30; ++i) {
    camera.approach(target, {0.3, -1, 0}, 0.1);
    const double now_m = (target - camera.target()).norm();
    EXPECT_LT(now_m, left_m);
    left_m = now_m;
  }
  EXPECT_LT(left_m, 0.01);
  for (int i = 0; i < 30; ++i) {
    camera.approach_distance(7, 0.1);
    EXPECT_LT(camera.distance_m(), 7);
  }
  EXPECT_NEAR(camera.distance_m(), 7, 0.02);
}

}  // namespace
}  // namespace ydd
