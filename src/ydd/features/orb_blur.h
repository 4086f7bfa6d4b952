// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ydd/features/orb_pyramid.h"

namespace ydd {

/// Smooths an image with the separable kernel (1 2 3 4 3 2 1) / 16 (variance 2.5 px^2, as a
/// Gaussian of 1.58 px). Thread: one call at a time.
class OrbBlur {
 public:
  static constexpr int kRadius_px = 3;

  /// Valid until the next call, and only at least kRadius_px from the border.
  GreyView apply(const GreyView& view);

 private:
  std::vector<std::uint8_t> pixels_;
  std::vector<std::uint8_t> row_;
};

}  // namespace ydd
