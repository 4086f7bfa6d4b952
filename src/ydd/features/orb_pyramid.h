// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ydd/features/orb_kernels.h"
#include "ydd/image/image.h"

namespace ydd {

/// Grey pixels that somebody else owns.
struct GreyView {
  const std::uint8_t* pixels = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  ///< from row to row, bytes

  const std::uint8_t* row(int y) const { return pixels + y * stride; }
};

/// Successively smaller copies of an image, each level `step` times smaller than the one before,
/// interpolated bilinearly.
///
/// Pixel centres are at integer coordinates: (x, y) of level l lies at
/// ((x + 0.5) step^l - 0.5, (y + 0.5) step^l - 0.5) of level 0, exactly, whatever the sizes.
/// Thread: one call at a time.
class OrbPyramid {
 public:
  /// `step` in (1, 2]. Levels narrower or lower than `min_size_px` are left out.
  OrbPyramid(int levels, double step, int min_size_px);

  /// The levels of `grey`; level 0 is the image itself, which must outlive the views. They hold
  /// until the next call.
  std::span<const GreyView> build(const GreyImage& grey);

 private:
  struct Level {
    std::vector<ShrunkEight> columns;  ///< an even number of them
    std::vector<std::uint8_t> pixels;
  };

  void allocate(int width_px, int height_px);
  void shrink(const GreyView& from, const Level& level, const GreyView& to,
              std::uint8_t* to_pixels);

  int max_levels_;
  double step_;
  int min_size_px_;
  std::vector<Level> levels_;  ///< [0] is unused
  std::vector<GreyView> views_;
  std::vector<std::int16_t> rows_[2];  ///< two neighbouring rows, shrunk horizontally, in 1/128
};

}  // namespace ydd
