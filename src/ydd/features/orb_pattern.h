// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace ydd {

/// One binary test of the descriptor: is the smoothed image darker at a than at b? Pixels from the
/// corner, in the patch turned to its canonical orientation (centroid along +x).
struct OrbTest {
  std::int8_t ax, ay, bx, by;
};

/// The 256 tests, all within kOrbPatchRadius_px of the corner. Written by tools/learn_orb_pattern.
inline constexpr std::array<OrbTest, 256> kOrbPattern = {{
#include "ydd/features/orb_pattern.inc"
}};

}  // namespace ydd
