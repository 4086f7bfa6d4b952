// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "ydd/base/timestamp.h"
#include "ydd/image/image.h"

namespace ydd {

/// One picture of an RGB-D camera: colour, its grey version, and depth registered to it, all of the
/// same size.
struct RgbdFrame {
  std::int64_t index = 0;  ///< position in the sequence, counts skipped frames too
  Timestamp stamp;         ///< of the colour image
  GreyImage grey;          ///< brightness of colour, what feature points are found in
  ColourImage colour;      ///< for detectors, pictures and the colours of clouds
  DepthImage depth_m;      ///< readings outside the camera's limits are already 0
};

}  // namespace ydd
