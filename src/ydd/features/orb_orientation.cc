// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_orientation.h"

#include <array>
#include <cmath>
#include <numbers>

#include "ydd/features/simd.h"

namespace ydd {
namespace {

using simd::I16;

struct Disc {
  /// All ones where (u, v) is within the disc; row v + radius, column u + radius.
  std::array<std::array<std::uint8_t, 32>, 2 * kOrbPatchRadius_px + 1> mask{};
  std::array<std::int16_t, 32> u{};
};

// The rim is at radius + 1/2: the disc of pixels that a circle of 15.5 px holds.
constexpr Disc make_disc() {
  Disc disc;
  for (int u = -kOrbPatchRadius_px; u <= kOrbPatchRadius_px; ++u) {
    disc.u[u + kOrbPatchRadius_px] = static_cast<std::int16_t>(u);
    for (int v = -kOrbPatchRadius_px; v <= kOrbPatchRadius_px; ++v) {
      const bool inside = u * u + v * v <= kOrbPatchRadius_px * (kOrbPatchRadius_px + 1);
      disc.mask[v + kOrbPatchRadius_px][u + kOrbPatchRadius_px] = inside ? 255 : 0;
    }
  }
  return disc;
}
constexpr Disc kDisc = make_disc();

}  // namespace

float intensity_centroid_angle_rad(const GreyView& view, int x, int y) {
  // Sums of each column and of each column weighted with v. Neither leaves 16 bits:
  // 31 * 255 = 7905, and 255 * (1 + ... + 15) = 30600 where all below is white, all above black.
  I16 sum_low = simd::splat16(0), sum_high = sum_low;
  I16 v_sum_low = sum_low, v_sum_high = sum_low;
  const std::uint8_t* row = view.row(y - kOrbPatchRadius_px) + x - kOrbPatchRadius_px;
  for (int v = -kOrbPatchRadius_px; v <= kOrbPatchRadius_px; ++v, row += view.stride) {
    const simd::U8 pixels =
        simd::bit_and(simd::load(row), simd::load(kDisc.mask[v + kOrbPatchRadius_px].data()));
    const I16 low = simd::low_half(pixels);
    const I16 high = simd::high_half(pixels);
    const I16 weight = simd::splat16(v);
    sum_low = simd::add(sum_low, low);
    sum_high = simd::add(sum_high, high);
    v_sum_low = simd::add(v_sum_low, simd::multiply(low, weight));
    v_sum_high = simd::add(v_sum_high, simd::multiply(high, weight));
  }
  const I16 one = simd::splat16(1);
  const int m10 = simd::dot(sum_low, simd::load(kDisc.u.data())) +
                  simd::dot(sum_high, simd::load(kDisc.u.data() + 16));
  const int m01 = simd::dot(v_sum_low, one) + simd::dot(v_sum_high, one);
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
