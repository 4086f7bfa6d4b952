// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ydd/features/features.h"
#include "ydd/features/orb_pattern.h"
#include "ydd/features/orb_pyramid.h"

namespace ydd {

/// Steered BRIEF: 256 brightness comparisons in a smoothed patch, the pattern turned by the
/// corner's orientation in steps of 2 pi / kAngles. Rublee et al., ICCV 2011, section 4.2.
class SteeredBrief {
 public:
  static constexpr int kAngles = 256;

  explicit SteeredBrief(std::span<const OrbTest, 256> pattern = kOrbPattern);

  /// Descriptor of pixel (x, y) of a smoothed level; the disc of kOrbPatchRadius_px around it, and
  /// one more column on its right, must hold valid pixels. Bit i is test i.
  Descriptor describe(const GreyView& smooth, int x, int y, float angle_rad) const;

 private:
  /// Of each angle, the 256 first and then the 256 second pixels, as offsets into a patch of
  /// kPatchStride bytes a row.
  std::vector<std::uint16_t> offsets_;
};

}  // namespace ydd
