// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/geometry/se3.h"

/// The simplest rigid motions, of which furniture and bodies are put together.
namespace ydd::sim {

/// Moves by that, in metres.
inline SE3 shift(double x, double y, double z) {
  return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, y, z)};
}
/// Turns about an axis of length 1 through the origin.
inline SE3 turn(const Eigen::Vector3d& axis, double angle_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis)), Eigen::Vector3d::Zero()};
}
/// Turns about z, upwards.
inline SE3 yaw(double angle_rad) { return turn(Eigen::Vector3d::UnitZ(), angle_rad); }

}  // namespace ydd::sim
