// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_orientation.h"

#include <array>
#include <cmath>
#include <numbers>

#include "ydd/features/orb_kernels.h"

namespace ydd {
float intensity_centroid_angle_rad(const GreyView& view, int x, int y) {
  const std::uint8_t* corner = view.row(y - kOrbPatchRadius_px) + x - kOrbPatchRadius_px;
  const auto [m10, m01] = orb_kernels().moments(corner, view.stride);
  return fast_atan2_rad(static_cast<float>(m01), static_cast<float>(m10));
}

// Two reductions bring the argument into [-tan(pi/8), tan(pi/8)], where seven terms of the series
// leave 2e-7.
float fast_atan2_rad(float y, float x) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float larger = ax > ay ? ax : ay;
  if (larger == 0.0F) return 0.0F;
  const float ratio = (ax > ay ? ay : ax) / larger;
  const bool steep = ratio > 0.41421356F;
  const float z = steep ? (ratio - 1.0F) / (ratio + 1.0F) : ratio;
  const float z2 = z * z;
  constexpr std::array<float, 7> kTaylor = {1.0F,     -1.0F / 3,  1.0F / 5, -1.0F / 7,
                                            1.0F / 9, -1.0F / 11, 1.0F / 13};
  float series = kTaylor.back();
  for (std::size_t i = kTaylor.size() - 1; i-- > 0;) series = series * z2 + kTaylor[i];
  series *= z;
  float angle = steep ? series + kPi / 4 : series;
  if (ay > ax) angle = kPi / 2 - angle;
  if (x < 0.0F) angle = kPi - angle;
  if (y < 0.0F) angle = 2 * kPi - angle;
  return angle < 2 * kPi ? angle : 0.0F;
}

}  // namespace ydd
