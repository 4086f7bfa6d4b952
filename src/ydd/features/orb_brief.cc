// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_brief.h"

#include <array>
#include <cmath>
#include <numbers>

#include "ydd/features/orb_orientation.h"
#include "ydd/features/simd.h"

namespace ydd {
namespace {

constexpr int kTests = 256;
constexpr int kPatchStride = 32;
constexpr double kTurn_rad = 2.0 * std::numbers::pi;

// Rounding may carry a pixel of the rim out of the disc; it stays inside the square.
std::uint16_t turned_offset(int x, int y, double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  const auto turned_x = static_cast<int>(std::lround(c * x - s * y));
  const auto turned_y = static_cast<int>(std::lround(s * x + c * y));
  return static_cast<std::uint16_t>((turned_y + kOrbPatchRadius_px) * kPatchStride + turned_x +
                                    kOrbPatchRadius_px);
}

}  // namespace

SteeredBrief::SteeredBrief(std::span<const OrbTest, 256> pattern)
    : offsets_(static_cast<std::size_t>(kAngles * 2 * kTests)) {
  for (int a = 0; a < kAngles; ++a) {
    const double angle_rad = a * kTurn_rad / kAngles;
    std::uint16_t* first = &offsets_[static_cast<std::size_t>(a * 2 * kTests)];
    for (int i = 0; i < kTests; ++i) {
      const OrbTest& test = pattern[i];
      first[i] = turned_offset(test.ax, test.ay, angle_rad);
      first[i + kTests] = turned_offset(test.bx, test.by, angle_rad);
    }
  }
}

Descriptor SteeredBrief::describe(const GreyView& smooth, int x, int y, float angle_rad) const {
  // A copy of the patch with a row length of its own makes the offsets independent of the image.
  alignas(64) std::array<std::uint8_t, (2 * kOrbPatchRadius_px + 1) * kPatchStride> patch;
  const std::uint8_t* row = smooth.row(y - kOrbPatchRadius_px) + x - kOrbPatchRadius_px;
  for (int v = 0; v <= 2 * kOrbPatchRadius_px; ++v, row += smooth.stride) {
    simd::store(&patch[v * kPatchStride], simd::load(row));
  }
  constexpr auto kAnglesPerRad = static_cast<float>(kAngles / kTurn_rad);
  const int angle = static_cast<int>(angle_rad * kAnglesPerRad + 0.5F) % kAngles;
  const std::uint16_t* offsets = &offsets_[static_cast<std::size_t>(angle * 2 * kTests)];
  alignas(64) std::array<std::uint8_t, 2 * kTests> sample;
  for (int i = 0; i < 2 * kTests; ++i) sample[i] = patch[offsets[i]];

  Descriptor descriptor;
  for (int i = 0; i < kTests; i += 64) {
    const auto bits = [&](int k) -> std::uint64_t {
      return ~simd::top_bits(
          simd::at_least(simd::load(&sample[k]), simd::load(&sample[k + kTests])));
    };
    descriptor[i / 64] = (bits(i) & 0xffffffffU) | bits(i + 32) << 32;
  }
  return descriptor;
}

}  // namespace ydd
