// SPDX-License-Identifier: Apache-2.0
#include "ydd/viewer/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace ydd {
namespace {

constexpr double kTurn_rad_per_px = std::numbers::pi / 600.0;
// Straight up or down the horizon has no direction; just short of it nobody sees the difference.
constexpr double kSteepest_rad = 1.55;
constexpr double kNearest_m = 0.1;
constexpr double kFarthest_m = 500.0;

/// Of the way, after so long.
double share_after(double elapsed_s) { return 1.0 - std::exp(-elapsed_s / OrbitCamera::kSettle_s); }

}  // namespace

void OrbitCamera::orbit(double dx_px, double dy_px) {
  set_angles(yaw_rad_ + dx_px * kTurn_rad_per_px, pitch_rad_ + dy_px * kTurn_rad_per_px);
}

void OrbitCamera::pan(double dx_px, double dy_px, double height_px) {
  const double m_per_px = 2 * distance_m_ * std::tan(kFieldOfView_rad / 2) / height_px;
  const Eigen::Matrix3d a = axes();
  target_ += m_per_px * (-dx_px * a.col(0) + dy_px * a.col(1));
}

void OrbitCamera::zoom(double steps) { set_distance(distance_m_ * std::pow(0.9, steps)); }

void OrbitCamera::approach_distance(double distance_m, double elapsed_s) {
  set_distance(distance_m_ + share_after(elapsed_s) * (distance_m - distance_m_));
}

void OrbitCamera::approach(const Eigen::Vector3d& target, const Eigen::Vector3d& up,
                           double elapsed_s) {
  const double share = share_after(elapsed_s);
  target_ += share * (target - target_);
  set_up(up_ + share * (up - up_));
}

void OrbitCamera::set_up(const Eigen::Vector3d& up) {
  if (up.norm() > 1e-6) up_ = up.normalized();
}

void OrbitCamera::set_angles(double yaw_rad, double pitch_rad) {
  yaw_rad_ = std::remainder(yaw_rad, 2 * std::numbers::pi);
  pitch_rad_ = std::clamp(pitch_rad, -kSteepest_rad, kSteepest_rad);
}

void OrbitCamera::set_distance(double distance_m) {
  distance_m_ = std::clamp(distance_m, kNearest_m, kFarthest_m);
}

void OrbitCamera::fit(const Eigen::Vector3d& centre, double radius_m) {
  target_ = centre;
  set_distance(radius_m / std::sin(kFieldOfView_rad / 2));
}

Eigen::Matrix3d OrbitCamera::axes() const {
  // Horizontal directions: world z flattened, or world y where up is z.
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ() - up_.z() * up_;
  if (forward.norm() < 0.1) forward = Eigen::Vector3d::UnitY() - up_.y() * up_;
  forward.normalize();
  const Eigen::Vector3d left = up_.cross(forward);
  const Eigen::Vector3d out = std::cos(yaw_rad_) * -forward + std::sin(yaw_rad_) * left;
  const Eigen::Vector3d back = std::cos(pitch_rad_) * out + std::sin(pitch_rad_) * up_;
  Eigen::Matrix3d axes;
  axes.col(2) = back;
  axes.col(0) = up_.cross(back).normalized();
  axes.col(1) = back.cross(axes.col(0));
  return axes;
}

Eigen::Vector3d OrbitCamera::eye() const { return target_ + distance_m_ * axes().col(2); }

Eigen::Matrix4d OrbitCamera::T_eye_world() const {
  const Eigen::Matrix3d a = axes();
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = a.transpose();
  view.topRightCorner<3, 1>() = -a.transpose() * eye();
  return view;
}

Eigen::Matrix4d OrbitCamera::projection(double aspect) const {
  // The depth buffer's precision goes with near / far: both follow the distance.
  const double near_m = 0.02 * distance_m_;
  const double far_m = 100.0 * distance_m_ + 100.0;
  const double f = 1.0 / std::tan(kFieldOfView_rad / 2);
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m(0, 0) = f / aspect;
  m(1, 1) = f;
  m(2, 2) = (far_m + near_m) / (near_m - far_m);
  m(2, 3) = 2 * far_m * near_m / (near_m - far_m);
  m(3, 2) = -1;
  return m;
}

}  // namespace ydd
