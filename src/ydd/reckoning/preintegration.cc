// SPDX-License-Identifier: Apache-2.0
#include "ydd/reckoning/preintegration.h"

#include <algorithm>
#include <cmath>

#include "ydd/geometry/se3_jacobians.h"

namespace ydd {
namespace {

constexpr double kLongestGap_s = 0.1;

/// Goes on for `dt_s` with this turn rate and acceleration, of the sensor's frame in its middle.
void step(Preintegrated& sum, const Eigen::Vector3d& gyro_rad_s, const Eigen::Vector3d& accel_m_s2,
          double dt_s) {
  const Eigen::Matrix3d R = (sum.turn * so3_exp(0.5 * dt_s * gyro_rad_s)).toRotationMatrix();
  const Eigen::Vector3d gain = R * accel_m_s2;
  sum.shift_m += dt_s * sum.speed_m_s + 0.5 * dt_s * dt_s * gain;
  sum.shift_by_bias += dt_s * sum.speed_by_bias - 0.5 * dt_s * dt_s * R;
  sum.speed_m_s += dt_s * gain;
  sum.speed_by_bias -= dt_s * R;
  sum.turn = (sum.turn * so3_exp(dt_s * gyro_rad_s)).normalized();
  sum.duration_s += dt_s;
}

/// Calls `take(gyro_rad_s, accel_m_s2, dt_s)` for each piece of [from, to]. False when the samples
/// do not cover it.
template <class Take>
bool walk(std::span<const ImuSample> samples, Timestamp from, Timestamp to, Take&& take) {
  const auto later = [](Timestamp stamp, const ImuSample& s) { return stamp < s.stamp; };
  auto next = std::upper_bound(samples.begin(), samples.end(), from, later);
  if (next == samples.begin()) return false;
  Timestamp now = from;
  for (auto held = next - 1; now < to; ++held) {
    const bool last = held + 1 == samples.end();
    const Timestamp until = last ? to : std::min(to, (held + 1)->stamp);
    if (seconds_between(held->stamp, last ? to : (held + 1)->stamp) > kLongestGap_s) {
      return false;
    }
    const ImuSample& after = last ? *held : *(held + 1);
    take(Eigen::Vector3d(0.5 * (held->gyro_rad_s + after.gyro_rad_s)),
         Eigen::Vector3d(0.5 * (held->accel_m_s2 + after.accel_m_s2)), seconds_between(now, until));
    now = until;
  }
  return true;
}

/// One step of derivatives and covariance; `m.sum` is as before it (Forster et al., equations A.8
/// to A.9 and the appendix on Jacobians by biases, with the turn taken in the middle of the step).
void step_errors(InertialMeasurement& m, const Eigen::Vector3d& gyro_rad_s,
                 const Eigen::Vector3d& accel_m_s2, const ImuNoise& noise, double dt_s) {
  const Eigen::Vector3d turned = dt_s * gyro_rad_s;
  const Eigen::Quaterniond half = so3_exp(0.5 * turned);
  const Eigen::Matrix3d R = (m.sum.turn * half).toRotationMatrix();
  const Eigen::Matrix3d back = so3_exp(turned).toRotationMatrix().transpose();
  const Eigen::Matrix3d half_back = half.toRotationMatrix().transpose();
  const Eigen::Matrix3d J = dt_s * so3_right_jacobian(turned);
  const Eigen::Matrix3d J_half = 0.5 * dt_s * so3_right_jacobian(0.5 * turned);
  const Eigen::Matrix3d gain_by_turn = -R * skew(accel_m_s2);  // turned on the right of R
  const double half_dt2 = 0.5 * dt_s * dt_s;

  const Eigen::Matrix3d gain = gain_by_turn * (half_back * m.turn_by_gyro_bias - J_half);
  m.shift_by_gyro_bias += dt_s * m.speed_by_gyro_bias + half_dt2 * gain;
  m.speed_by_gyro_bias += dt_s * gain;
  m.turn_by_gyro_bias = back * m.turn_by_gyro_bias - J;

  Matrix9d A = Matrix9d::Identity();
  A.block<3, 3>(0, 0) = back;
  A.block<3, 3>(3, 0) = dt_s * gain_by_turn * half_back;
  A.block<3, 3>(6, 0) = half_dt2 * gain_by_turn * half_back;
  A.block<3, 3>(6, 3) = dt_s * Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 9, 6> B = Eigen::Matrix<double, 9, 6>::Zero();
  B.block<3, 3>(0, 0) = J;
  B.block<3, 3>(3, 0) = dt_s * gain_by_turn * J_half;
  B.block<3, 3>(6, 0) = half_dt2 * gain_by_turn * J_half;
  B.block<3, 3>(3, 3) = dt_s * R;
  B.block<3, 3>(6, 3) = half_dt2 * R;
  B.leftCols<3>() *= noise.gyro_rad_s / std::sqrt(dt_s);
  B.rightCols<3>() *= noise.accel_m_s2 / std::sqrt(dt_s);
  m.covariance = A * m.covariance * A.transpose() + B * B.transpose();
}

}  // namespace

std::optional<Preintegrated> preintegrate(std::span<const ImuSample> samples, Timestamp from,
                                          Timestamp to, const Eigen::Vector3d& gyro_bias_rad_s,
                                          const Eigen::Vector3d& accel_bias_m_s2) {
  Preintegrated sum;
  const auto take = [&](const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel, double dt_s) {
    step(sum, gyro - gyro_bias_rad_s, accel - accel_bias_m_s2, dt_s);
  };
  if (!walk(samples, from, to, take)) return std::nullopt;
  return sum;
}

std::optional<InertialMeasurement> measure_inertial(std::span<const ImuSample> samples,
                                                    Timestamp from, Timestamp to,
                                                    const Eigen::Vector3d& gyro_bias_rad_s,
                                                    const Eigen::Vector3d& accel_bias_m_s2,
                                                    const ImuNoise& noise) {
  InertialMeasurement m;
  m.gyro_bias_rad_s = gyro_bias_rad_s;
  m.accel_bias_m_s2 = accel_bias_m_s2;
  const auto take = [&](const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel, double dt_s) {
    if (dt_s <= 0) return;
    step_errors(m, gyro - gyro_bias_rad_s, accel - accel_bias_m_s2, noise, dt_s);
    step(m.sum, gyro - gyro_bias_rad_s, accel - accel_bias_m_s2, dt_s);
  };
  if (!walk(samples, from, to, take)) return std::nullopt;
  return m;
}

Preintegrated InertialMeasurement::with_biases(const Eigen::Vector3d& gyro_rad_s,
                                               const Eigen::Vector3d& accel_m_s2) const {
  const Eigen::Vector3d gyro = gyro_rad_s - gyro_bias_rad_s, accel = accel_m_s2 - accel_bias_m_s2;
  Preintegrated out = sum;
  out.turn = (sum.turn * so3_exp(turn_by_gyro_bias * gyro)).normalized();
  out.speed_m_s += sum.speed_by_bias * accel + speed_by_gyro_bias * gyro;
  out.shift_m += sum.shift_by_bias * accel + shift_by_gyro_bias * gyro;
  return out;
}

}  // namespace ydd
