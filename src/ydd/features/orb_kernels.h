// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace ydd {

/// A corner on one pyramid level, at a whole pixel of that level.
struct Corner {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  std::uint16_t score = 0;  ///< FAST-9 score, 1 to 255
};

/// How eight neighbouring pixels of a smaller row come from 16 bytes of the larger one: pixel k
/// is weight[2k] * source[first + index[2k]] + weight[2k+1] * source[first + index[2k+1]], in
/// 1/128.
struct ShrunkEight {
  int first = 0;
  std::uint8_t index[16] = {};
  std::uint8_t weight[16] = {};
};

/// So many pixels are taken at once: rows and buffers go on for as much behind their last one.
inline constexpr int kOrbVector_px = 32;

/// Radius of the disc around a corner that orientation and descriptor look at.
inline constexpr int kOrbPatchRadius_px = 15;

/// First moments of the intensity in a disc.
struct PatchMoments {
  int m10 = 0;  ///< along x
  int m01 = 0;  ///< along y
};

/// The inner loops of the extractor for one vector instruction set. All sets give the same results,
/// bit for bit (orb_kernels_test.cc), so that what is computed does not depend on the processor.
struct OrbKernels {
  const char* instruction_set;
  /// FAST-9 scores above `threshold` of the pixels [begin, end) of the middle one of seven rows;
  /// zero or more behind it up to a whole vector.
  void (*score_row)(const std::uint8_t* const* rows, int begin, int end, int threshold,
                    std::uint8_t* scores);
  /// Writes the maxima among eight neighbours at x in [begin, end) of a row of scores, and gives
  /// their number. Strictly above the neighbours that come before in reading order.
  std::size_t (*find_maxima)(const std::uint8_t* above, const std::uint8_t* row,
                             const std::uint8_t* below, int begin, int end, int y, Corner* corners);
  /// (1 2 3 4 3 2 1) / 16 down the columns, and along the row for x in [begin, end).
  void (*blur_columns)(const std::uint8_t* in, std::ptrdiff_t stride, int width, std::uint8_t* out);
  void (*blur_along)(const std::uint8_t* in, int begin, int end, std::uint8_t* out);
  /// `count` (even) times eight pixels in 1/128.
  void (*shrink_row)(const std::uint8_t* in, const ShrunkEight* columns, std::size_t count,
                     std::int16_t* out);
  /// Pixels between two shrunk rows, `weight` / 128 of the lower one, in whole vectors up to width.
  void (*blend_rows)(const std::int16_t* upper, const std::int16_t* lower, int weight, int width,
                     std::uint8_t* out);
  /// Of the disc whose bounding box begins at `corner`, seen from its centre.
  PatchMoments (*moments)(const std::uint8_t* corner, std::ptrdiff_t stride);
};

/// Those for the best set that this processor has.
const OrbKernels& orb_kernels();

/// All that this processor can run; the best one last.
std::span<const OrbKernels* const> runnable_orb_kernels();

/// One for the processor that everything is compiled for, one for AVX2 (x86-64 only).
extern const OrbKernels kBaselineOrbKernels;
extern const OrbKernels kAvx2OrbKernels;

}  // namespace ydd
