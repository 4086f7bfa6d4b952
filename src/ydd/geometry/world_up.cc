// SPDX-License-Identifier: Apache-2.0
#include "ydd/geometry/world_up.h"

#include <Eigen/Cholesky>

namespace ydd {
namespace {

// What the mean of -y weighs against the x axes: enough to decide where these say nothing.
constexpr double kMeanWeight = 0.02;

}  // namespace

Eigen::Vector3d world_up(const std::vector<SE3>& T_world_cameras) {
  // min over up of  sum (up . x_i)^2 + w n |up - mean|^2,  mean = that of -y_i.
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SE3& T_world_camera : T_world_cameras) {
    const Eigen::Matrix3d r = T_world_camera.rotation_matrix();
    spread += r.col(0) * r.col(0).transpose();
    sum -= r.col(1);
  }
  if (sum.norm() < 1e-9) return {0, -1, 0};
  const double weight = kMeanWeight * static_cast<double>(T_world_cameras.size());
  const Eigen::Matrix3d normal = spread + weight * Eigen::Matrix3d::Identity();
  return normal.ldlt().solve(kMeanWeight * sum).normalized();
}

}  // namespace ydd
