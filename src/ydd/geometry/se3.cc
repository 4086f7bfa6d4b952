// SPDX-License-Identifier: Apache-2.0
#include "ydd/geometry/se3.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/LU>

#include "ydd/geometry/se3_jacobians.h"

namespace ydd {

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond so3_exp(const Eigen::Vector3d& w) {
  const double theta2 = w.squaredNorm();
  double real = 1.0 - theta2 / 8.0;
  double scale = 0.5 - theta2 / 48.0;  // sin(t/2) / t
  if (theta2 > 1e-8) {
    const double theta = std::sqrt(theta2);
    real = std::cos(0.5 * theta);
    scale = std::sin(0.5 * theta) / theta;
  }
  return Eigen::Quaterniond(real, scale * w.x(), scale * w.y(), scale * w.z()).normalized();
}

Eigen::Vector3d so3_log(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * rotation.vec();
  const double w = sign * rotation.w();
  const double n = v.norm();
  if (n < 1e-10) return 2.0 / w * v;
  return 2.0 * std::atan2(n, w) / n * v;
}

Eigen::Matrix4d SE3::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation_matrix();
  m.topRightCorner<3, 1>() = translation_;
  return m;
}

SE3 SE3::from_stored(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation) {
  // Written so that what is not a number fails as well.
  if (!(std::abs(rotation.squaredNorm() - 1.0) < 2e-9) || !translation.allFinite()) {
    throw std::logic_error("SE3: stored numbers are no rigid motion");
  }
  SE3 out;
  out.rotation_ = rotation;
  out.translation_ = translation;
  return out;
}

SE3 SE3::inverse() const {
  const Eigen::Quaterniond r = rotation_.conjugate();
  return {r, -(r * translation_)};
}

SE3 SE3::exp(const Vector6d& twist) {
  const Eigen::Vector3d w = twist.tail<3>();
  return {so3_exp(w), so3_left_jacobian(w) * twist.head<3>()};
}

Vector6d SE3::log() const {
  const Eigen::Vector3d w = so3_log(rotation_);
  Vector6d twist;
  twist.head<3>() = so3_left_jacobian(w).inverse() * translation_;
  twist.tail<3>() = w;
  return twist;
}

double SE3::angle_rad() const {
  return 2.0 * std::atan2(rotation_.vec().norm(), std::abs(rotation_.w()));
}

}  // namespace ydd
