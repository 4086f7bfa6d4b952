// SPDX-License-Identifier: Apache-2.0
// A sensor that is carried along a known path, for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "ydd/reckoning/motion_samples.h"

namespace ydd::carried_sensor {

inline Timestamp at(double t_s) { return {std::llround(t_s * 1e9)}; }

/// T_world_imu of somebody who looks round a room while walking; z up.
inline SE3 path(double t_s) {
  const Eigen::Vector3d turn(0.2 * std::sin(0.9 * t_s), 0.3 * std::sin(0.7 * t_s + 1), 0.4 * t_s);
  const Eigen::Vector3d place(0.8 * std::sin(0.8 * t_s), 0.5 * std::cos(0.6 * t_s),
                              1.4 + 0.1 * std::sin(1.7 * t_s));
  return {so3_exp(turn), place};
}

inline Eigen::Vector3d speed_m_s(double t_s) {
  constexpr double kStep = 1e-4;
  return (path(t_s + kStep).translation() - path(t_s - kStep).translation()) / (2 * kStep);
}

struct Faults {
  Eigen::Vector3d gyro_bias_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_m_s2 = Eigen::Vector3d::Zero();
  double gyro_sigma_rad_s = 0, accel_sigma_m_s2 = 0;  ///< of each sample
  unsigned seed = 1;
};

inline std::vector<ImuSample> imu(double from_s, double until_s, const Faults& faults = {}) {
  constexpr double kHz = 200.0, kStep = 1e-3;
  std::mt19937 random(faults.seed);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Eigen::Vector3d(sigma * Eigen::Vector3d(x, y, z));
  };
  std::vector<ImuSample> out;
  for (double t = from_s; t < until_s; t += 1.0 / kHz) {
    const SE3 before = path(t - kStep), now = path(t), after = path(t + kStep);
    const Eigen::Vector3d accel =
        (after.translation() - 2 * now.translation() + before.translation()) / (kStep * kStep);
    ImuSample s;
    s.stamp = at(t);
    s.gyro_rad_s = so3_log(before.rotation().conjugate() * after.rotation()) / (2 * kStep) +
                   faults.gyro_bias_rad_s + noise(faults.gyro_sigma_rad_s);
    s.accel_m_s2 = now.rotation().conjugate() * (accel + Eigen::Vector3d(0, 0, 9.81)) +
                   faults.accel_bias_m_s2 + noise(faults.accel_sigma_m_s2);
    out.push_back(s);
  }
  return out;
}

}  // namespace ydd::carried_sensor
