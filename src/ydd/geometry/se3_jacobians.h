// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/geometry/se3.h"

/// Derivatives of rigid motions, for solvers. Twists are (translation, rotation).
/// Source: T. Barfoot, State Estimation for Robotics, 2017, chapter 7.
namespace ydd {

/// Left Jacobian of SO(3), eq. (7.37): `so3_exp(w + d) = so3_exp(J(w) d) * so3_exp(w)` for small d.
Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& w);

/// Right one, its transpose: `so3_exp(w + d) = so3_exp(w) * so3_exp(J(w) d)` for small d.
Eigen::Matrix3d so3_right_jacobian(const Eigen::Vector3d& w);

/// Adjoint: `T * exp(twist) = exp(adjoint(T) * twist) * T`.
Matrix6d adjoint(const SE3& T);

/// Left Jacobian of SE(3), eq. (7.85): `exp(twist + d) = exp(J(twist) d) * exp(twist)`, small d.
Matrix6d se3_left_jacobian(const Vector6d& twist);

/// Its inverse: `log(exp(d) * exp(twist)) = twist + J^-1(twist) d` for small d. And with d on the
/// right, `log(exp(twist) * exp(d)) = twist + J^-1(-twist) d`. Rotation angle below 2 pi.
Matrix6d se3_left_jacobian_inverse(const Vector6d& twist);

}  // namespace ydd
