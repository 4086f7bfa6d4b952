// SPDX-License-Identifier: Apache-2.0
#include "ydd/geometry/se3_jacobians.h"

#include <cmath>

#include <Eigen/LU>

namespace ydd {
namespace {

/// Factors of eq. (7.86b); as series where the closed forms cancel.
struct Factors {
  double a, b, c;
};

Factors factors_of(double angle2) {
  if (angle2 < 1e-2) {
    return {1.0 / 6.0 - angle2 / 120.0 + angle2 * angle2 / 5040.0,
            1.0 / 24.0 - angle2 / 720.0 + angle2 * angle2 / 40320.0,
            1.0 / 120.0 - angle2 / 2520.0 + angle2 * angle2 / 120960.0};
  }
  const double angle = std::sqrt(angle2);
  const double s = std::sin(angle);
  const double c = std::cos(angle);
  return {(angle - s) / (angle2 * angle), (angle2 + 2.0 * c - 2.0) / (2.0 * angle2 * angle2),
          (2.0 * angle - 3.0 * s + angle * c) / (2.0 * angle2 * angle2 * angle)};
}

/// How translation and rotation are coupled in the left Jacobian, eq. (7.86b).
Eigen::Matrix3d coupling_of(const Vector6d& twist) {
  const Eigen::Matrix3d P = skew(twist.head<3>());
  const Eigen::Matrix3d W = skew(twist.tail<3>());
  const Factors f = factors_of(twist.tail<3>().squaredNorm());
  const Eigen::Matrix3d WP = W * P;
  const Eigen::Matrix3d PW = P * W;
  const Eigen::Matrix3d WPW = WP * W;
  return 0.5 * P + f.a * (WP + PW + WPW) + f.b * (W * WP + PW * W - 3.0 * WPW) +
         f.c * (WPW * W + W * WPW);
}

}  // namespace

Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& w) {
  const double theta2 = w.squaredNorm();
  const Eigen::Matrix3d W = skew(w);
  double a = 0.5 - theta2 / 24.0;         // (1 - cos t) / t^2
  double b = 1.0 / 6.0 - theta2 / 120.0;  // (t - sin t) / t^3
  if (theta2 > 1e-8) {
    const double theta = std::sqrt(theta2);
    a = (1.0 - std::cos(theta)) / theta2;
    b = (theta - std::sin(theta)) / (theta2 * theta);
  }
  return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}

Eigen::Matrix3d so3_right_jacobian(const Eigen::Vector3d& w) {
  return so3_left_jacobian(w).transpose();
}

Matrix6d adjoint(const SE3& T) {
  const Eigen::Matrix3d R = T.rotation_matrix();
  Matrix6d m;
  m << R, skew(T.translation()) * R, Eigen::Matrix3d::Zero(), R;
  return m;
}

Matrix6d se3_left_jacobian(const Vector6d& twist) {
  const Eigen::Matrix3d J = so3_left_jacobian(twist.tail<3>());
  Matrix6d m;
  m << J, coupling_of(twist), Eigen::Matrix3d::Zero(), J;
  return m;
}

Matrix6d se3_left_jacobian_inverse(const Vector6d& twist) {
  const Eigen::Matrix3d inverse = so3_left_jacobian(twist.tail<3>()).inverse();
  Matrix6d m;
  m << inverse, -inverse * coupling_of(twist) * inverse, Eigen::Matrix3d::Zero(), inverse;
  return m;
}

}  // namespace ydd
