// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/reprojection.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

Eigen::Vector3d uvr_of(const Intrinsics& k, const Eigen::Vector3d& p_camera) {
  const Reprojection<double> seen(k, p_camera.x(), p_camera.y(), p_camera.z());
  return {seen.u, seen.v, seen.r};
}

const std::vector<Eigen::Vector3d> kPoints{
    {0, 0, 1}, {0.4, -0.3, 0.6}, {-2.0, 1.5, 4.0}, {1.0, 1.0, 9.0}, {0.01, -0.9, 1.1}};

Camera skewed_camera() {
  Camera camera;
  camera.fx_px = 517.3;
  camera.fy_px = 500.1;
  camera.cx_px = 318.6;
  camera.cy_px = 255.3;
  return camera;
}

TEST(Reprojection, AgreesWithTheCamera) {
  const Camera camera = skewed_camera();
  for (const Eigen::Vector3d& p : kPoints) {
    const Eigen::Vector3d uvr = uvr_of(Intrinsics(camera), p);
    EXPECT_LT((uvr.head<2>() - camera.project(p)).norm(), 1e-10);
    EXPECT_NEAR(uvr.x() - uvr.z(), camera.bf() / p.z(), 1e-10);
  }
}

TEST(Reprojection, DerivativesMatchNumericOnes) {
  const Intrinsics k{skewed_camera()};
  constexpr double kStep = 1e-6;
  for (const Eigen::Vector3d& p : kPoints) {
    const auto analytic = twist_jacobian(Reprojection<double>(k, p.x(), p.y(), p.z()));
    for (int axis = 0; axis < 6; ++axis) {
      Vector6d twist = Vector6d::Zero();
      twist[axis] = kStep;
      const Eigen::Vector3d numeric =
          (uvr_of(k, SE3::exp(twist) * p) - uvr_of(k, SE3::exp(-twist) * p)) / (2.0 * kStep);
      EXPECT_LT((analytic.col(axis) - numeric).norm(), 1e-6 * (1.0 + numeric.norm()))
          << "axis " << axis << " point " << p.transpose();
    }
  }
}

}  // namespace
}  // namespace ydd
