// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "ydd/reckoning/preintegration.h"

namespace ydd {

/// A moment at which the pose was seen.
struct InertialNode {
  Timestamp stamp;
  SE3 T_world_imu;
};

/// What the accelerometer measures besides motion: stays the same for long.
struct InertialState {
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d::Zero();  ///< in the world
  Eigen::Vector3d accel_bias_m_s2 = Eigen::Vector3d::Zero();
};

/// What is known of an InertialState from earlier: normal equations `information * x = sum`, of
/// gravity and bias stacked.
struct InertialPrior {
  Matrix6d information = Matrix6d::Zero();
  Vector6d sum = Vector6d::Zero();
};

/// What the readings of some nodes tell.
struct InertialFit {
  InertialState state;
  Eigen::Vector3d speed_m_s =
      Eigen::Vector3d::Zero();  ///< of the IMU in the world, at the last node
  InertialPrior learnt;         ///< what these nodes say of the state, without the prior
};

/// Velocities, gravity and bias that explain best how the nodes lie (`between[k]` is what the IMU
/// says from node k to k + 1): linear least squares, the length of gravity being known (Mur-Artal,
/// Tardos, "Visual-Inertial Monocular SLAM with Map Reuse", RA-L 2017, section IV, with the scale
/// that depth gives). Nothing with fewer than four nodes.
std::optional<InertialFit> fit_inertial(std::span<const InertialNode> nodes,
                                        std::span<const Preintegrated> between,
                                        const InertialPrior& prior);

}  // namespace ydd
