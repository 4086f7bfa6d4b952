// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ydd/simulation/canvas.h"

namespace ydd::sim {

/// What happens outside a texture: its border goes on, or it repeats (sizes are powers of two).
enum class Wrap { clamp, repeat };

/// How texture coordinates (texels of level 0) change from one pixel to its right and lower
/// neighbour.
struct Footprint {
  Vector2 along_x;
  Vector2 along_y;
};

/// One level of a mip pyramid.
struct MipLevel {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> texels;  ///< blue in the lowest byte, green, red
};

/// A picture with its mip pyramid, filtered trilinearly along the longer axis of the pixel's
/// footprint (a few probes, after Feline, McCormack et al. 1999), so that corners stay where they
/// are from one frame to the next. Immutable after construction.
class Texture {
 public:
  /// @throws std::logic_error if `wrap` is repeat and a side is no power of two.
  Texture(const Canvas& canvas, Wrap wrap);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  /// Mean colour over the footprint around (u, v), texels of level 0, texel centres at + 0.5.
  Colour sample(float u, float v, const Footprint& footprint) const;

 private:
  Wrap wrap_;
  std::vector<MipLevel> levels_;
};

}  // namespace ydd::sim
