// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ydd/features/orb_kernels.h"
#include "ydd/features/orb_pyramid.h"

namespace ydd {

/// FAST-9 corners: pixels whose 16-pixel circle of radius 3 holds nine neighbouring pixels that are
/// all brighter, or all darker, than the centre by more than a threshold. Rosten and Drummond,
/// "Machine learning for high-speed corner detection", ECCV 2006.
///
/// The score is the difference that all of the best nine reach, so that a corner at threshold t is
/// a pixel of score > t; kept are the maxima of the score among their eight neighbours (of equal
/// ones the first in reading order).
class CornerDetector {
 public:
  /// Corners of score > `low_threshold`, at least `border_px` (>= 4) from the border of the image,
  /// in reading order. In each cell of about 35 px that holds one of score > `threshold`, only
  /// those. Valid until the next call.
  std::span<const Corner> detect(const GreyView& view, int border_px, int threshold,
                                 int low_threshold);

 private:
  std::size_t find_all(const GreyView& view, int border_px, int low_threshold);
  std::size_t keep_strong_of_cells(std::size_t count, const GreyView& view, int border_px,
                                   int threshold);

  std::vector<std::uint8_t> scores_;  ///< three rows
  std::vector<Corner> corners_;
  std::vector<std::uint8_t> cell_is_strong_;
  std::vector<std::uint8_t> column_of_x_;
};

}  // namespace ydd
