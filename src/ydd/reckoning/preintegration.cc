// SPDX-License-Identifier: Apache-2.0
#include "ydd/reckoning/preintegration.h"

#include <algorithm>

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

}  // namespace

std::optional<Preintegrated> preintegrate(std::span<const ImuSample> samples, Timestamp from,
                                          Timestamp to, const Eigen::Vector3d& gyro_bias_rad_s,
                                          const Eigen::Vector3d& accel_bias_m_s2) {
  const auto later = [](Timestamp stamp, const ImuSample& s) { return stamp < s.stamp; };
  auto next = std::upper_bound(samples.begin(), samples.end(), from, later);
  if (next == samples.begin()) return std::nullopt;
  Preintegrated sum;
  Timestamp now = from;
  for (auto held = next - 1; now < to; ++held) {
    const bool last = held + 1 == samples.end();
    const Timestamp until = last ? to : std::min(to, (held + 1)->stamp);
    if (seconds_between(held->stamp, last ? to : (held + 1)->stamp) > kLongestGap_s) {
      return std::nullopt;
    }
    const ImuSample& after = last ? *held : *(held + 1);
    step(sum, 0.5 * (held->gyro_rad_s + after.gyro_rad_s) - gyro_bias_rad_s,
         0.5 * (held->accel_m_s2 + after.accel_m_s2) - accel_bias_m_s2,
         seconds_between(now, until));
    now = until;
  }
  return sum;
}

}  // namespace ydd
