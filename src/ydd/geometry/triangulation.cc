// SPDX-License-Identifier: Apache-2.0
#include "ydd/geometry/triangulation.h"

#include <Eigen/SVD>

namespace ydd {

std::optional<Eigen::Vector3d> triangulate(const SE3& T_camera1_world, const Eigen::Vector3d& ray1,
                                           const SE3& T_camera2_world,
                                           const Eigen::Vector3d& ray2) {
  const Eigen::Matrix4d P1 = T_camera1_world.matrix();
  const Eigen::Matrix4d P2 = T_camera2_world.matrix();
  Eigen::Matrix4d A;
  A.row(0) = ray1.x() * P1.row(2) - P1.row(0);
  A.row(1) = ray1.y() * P1.row(2) - P1.row(1);
  A.row(2) = ray2.x() * P2.row(2) - P2.row(0);
  A.row(3) = ray2.y() * P2.row(2) - P2.row(1);
  const Eigen::JacobiSVD<Eigen::Matrix4d> svd(A, Eigen::ComputeFullV);
  const Eigen::Vector4d h = svd.matrixV().col(3);
  if (std::abs(h.w()) < 1e-12) return std::nullopt;
  return Eigen::Vector3d(h.head<3>() / h.w());
}

}  // namespace ydd
