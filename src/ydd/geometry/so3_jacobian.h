// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "ydd/geometry/se3.h"

namespace ydd {

/// Right Jacobian of a rotation vector: `exp(v + d) = exp(v) * exp(J * d)` for a small d (Forster
/// et al., T-RO 2017, equation 8).
inline Eigen::Matrix3d so3_right_jacobian(const Eigen::Vector3d& v) {
  const double angle2 = v.squaredNorm();
  const Eigen::Matrix3d V = skew(v);
  double a = 0.5 - angle2 / 24.0, b = 1.0 / 6.0 - angle2 / 120.0;  // where the angle is small
  if (angle2 > 1e-6) {
    const double angle = std::sqrt(angle2);
    a = (1.0 - std::cos(angle)) / angle2;
    b = (angle - std::sin(angle)) / (angle2 * angle);
  }
  return Eigen::Matrix3d::Identity() - a * V + b * V * V;
}

/// Its inverse: `log(exp(v) * exp(d)) = v + J * d`.
inline Eigen::Matrix3d so3_right_jacobian_inverse(const Eigen::Vector3d& v) {
  const double angle2 = v.squaredNorm();
  const Eigen::Matrix3d V = skew(v);
  double b = 1.0 / 12.0 + angle2 / 720.0;
  if (angle2 > 1e-6) {
    const double angle = std::sqrt(angle2);
    b = 1.0 / angle2 - (1.0 + std::cos(angle)) / (2.0 * angle * std::sin(angle));
  }
  return Eigen::Matrix3d::Identity() + 0.5 * V + b * V * V;
}

}  // namespace ydd
