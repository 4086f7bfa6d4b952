// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ydd/reckoning/preintegration.h"

namespace ydd {

/// What a bundle with an IMU finds out besides poses and points.
struct InertialUnknowns {
  std::vector<Eigen::Vector3d> speed_m_s;  ///< per pose: of the IMU, in the world
  Eigen::Vector3d gyro_bias_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_m_s2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d gravity_m_s2{0, 0, -9.81};  ///< in the world; only its direction is sought
};

/// What the IMU measured from one pose of a bundle to a later one.
struct InertialLink {
  int from = 0, to = 0;  ///< indices into BundleProblem::poses
  InertialMeasurement measured;
};

/// The inertial part of a bundle problem. A window of some seconds has one pair of biases: within
/// it they change by less than can be seen.
struct InertialProblem {
  SE3 T_camera_imu;
  std::vector<InertialLink> links;
  InertialUnknowns start;                                            ///< also the mean of the prior
  double gyro_bias_sigma_rad_s = 0.01, accel_bias_sigma_m_s2 = 0.2;  ///< of the prior
  double gravity_sigma_rad = 0.1;
};

/// Derivatives of one link stand in this order: two poses (left twists of T_camera_world), two
/// speeds, biases of gyroscope and accelerometer, and gravity's turn about two axes across it.
namespace inertial_order {
constexpr int kFrom = 0, kTo = 6, kSpeedFrom = 12, kSpeedTo = 15, kGlobal = 18, kGravity = 24;
constexpr int kGlobals = 8, kAll = kGlobal + kGlobals;
}  // namespace inertial_order

/// Two unit vectors across gravity, about which its direction turns.
Eigen::Matrix<double, 3, 2> axes_across(const Eigen::Vector3d& gravity_m_s2);

/// Residuals of turn, speed and shift (Forster et al., T-RO 2017, equation 45) at some poses and
/// unknowns, and their derivatives.
struct LinkError {
  Eigen::Matrix<double, 9, 1> residual;
  Eigen::Matrix<double, 9, inertial_order::kAll> jacobian;
};
LinkError link_error(const InertialProblem& problem, const InertialLink& link,
                     const SE3& T_from_world, const SE3& T_to_world, const InertialUnknowns& x);

}  // namespace ydd
