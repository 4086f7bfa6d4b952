// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "ydd/reckoning/motion_samples.h"

namespace ydd {

/// What an IMU adds up to between two moments, in its frame at the first of them and without
/// gravity (Forster, Carlone, Dellaert, Scaramuzza, "On-Manifold Preintegration for Real-Time
/// Visual-Inertial Odometry", T-RO 2017, equation 33).
struct Preintegrated {
  double duration_s = 0;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< R_then_now
  Eigen::Vector3d speed_m_s = Eigen::Vector3d::Zero();       ///< gained
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();         ///< by that gain alone
  Eigen::Matrix3d speed_by_bias = Eigen::Matrix3d::Zero();   ///< derivative by the accelerometer's
  Eigen::Matrix3d shift_by_bias = Eigen::Matrix3d::Zero();
};

/// Nothing when the samples (in the order of time) do not cover [from, to]: the first is later, or
/// more than a tenth of a second passes without one. The last one holds until `to`.
std::optional<Preintegrated> preintegrate(std::span<const ImuSample> samples, Timestamp from,
                                          Timestamp to, const Eigen::Vector3d& gyro_bias_rad_s,
                                          const Eigen::Vector3d& accel_bias_m_s2);

/// White noise of an IMU: standard deviations per square root of Hz.
struct ImuNoise {
  double gyro_rad_s = 0.001;
  double accel_m_s2 = 0.01;
};

using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// The same as a factor between two poses (Forster et al., section VI; first by Lupton, Sukkarieh,
/// "Visual-Inertial-Aided Navigation for High-Dynamic Motion in Built Environments Without Initial
/// Conditions", T-RO 2012): how sure it is, and what another gyroscope's bias would make of it.
struct InertialMeasurement {
  Preintegrated sum;
  Eigen::Vector3d gyro_bias_rad_s = Eigen::Vector3d::Zero();  ///< that it was added up with
  Eigen::Vector3d accel_bias_m_s2 = Eigen::Vector3d::Zero();
  Eigen::Matrix3d turn_by_gyro_bias = Eigen::Matrix3d::Zero();  ///< on the right of `turn`
  Eigen::Matrix3d speed_by_gyro_bias = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d shift_by_gyro_bias = Eigen::Matrix3d::Zero();
  Matrix9d covariance = Matrix9d::Zero();  ///< of turn (on its right), speed and shift, by noise

  /// To first order, as it would be with other biases.
  Preintegrated with_biases(const Eigen::Vector3d& gyro_rad_s,
                            const Eigen::Vector3d& accel_m_s2) const;
};

/// As `preintegrate`; costs some five times as much.
std::optional<InertialMeasurement> measure_inertial(std::span<const ImuSample> samples,
                                                    Timestamp from, Timestamp to,
                                                    const Eigen::Vector3d& gyro_bias_rad_s,
                                                    const Eigen::Vector3d& accel_bias_m_s2,
                                                    const ImuNoise& noise);

}  // namespace ydd
