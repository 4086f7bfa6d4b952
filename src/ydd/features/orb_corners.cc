// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_corners.h"

#include <algorithm>
#include <array>

#include "ydd/features/orb_kernels.h"

namespace ydd {
namespace {

constexpr int kCell_px = 35;

int cells_along(int size_px) { return std::max(1, size_px / kCell_px); }

}  // namespace

std::span<const Corner> CornerDetector::detect(const GreyView& view, int border_px, int threshold,
                                               int low_threshold) {
  if (view.width <= 2 * border_px || view.height <= 2 * border_px) return {};
  std::size_t count = find_all(view, border_px, std::min(low_threshold, threshold));
  if (low_threshold < threshold) {
    count = keep_strong_of_cells(count, view, border_px, threshold);
  }
  return {corners_.data(), count};
}

std::size_t CornerDetector::find_all(const GreyView& view, int border_px, int low_threshold) {
  // Scores are needed one pixel around the area; vectors may run over its right end by a vector.
  const int x_begin = border_px;
  const int x_end = view.width - border_px;
  const int y_begin = border_px;
  const int y_end = view.height - border_px;
  const auto row_size = static_cast<std::size_t>(view.width + 2 * kOrbVector_px);
  const OrbKernels& kernels = orb_kernels();
  scores_.assign(3 * row_size, 0);
  std::size_t count = 0;
  for (int y = y_begin - 1; y <= y_end; ++y) {
    std::array<const std::uint8_t*, 7> rows;
    for (int i = 0; i < 7; ++i) rows[i] = view.row(y + i - 3);
    kernels.score_row(rows.data(), x_begin - 1, x_end + 1, low_threshold,
                      &scores_[(y % 3) * row_size]);
    if (y <= y_begin) continue;
    const std::uint8_t* above = &scores_[((y - 2) % 3) * row_size];
    const std::uint8_t* row = &scores_[((y - 1) % 3) * row_size];
    const std::uint8_t* below = &scores_[(y % 3) * row_size];
    if (corners_.size() < count + view.width) corners_.resize(2 * count + 4 * view.width);
    count += kernels.find_maxima(above, row, below, x_begin, x_end, y - 1, &corners_[count]);
  }
  return count;
}

std::size_t CornerDetector::keep_strong_of_cells(std::size_t count, const GreyView& view,
                                                 int border_px, int threshold) {
  const int width = view.width - 2 * border_px;
  const int height = view.height - 2 * border_px;
  const int columns = cells_along(width);
  const int rows = cells_along(height);
  cell_is_strong_.assign(static_cast<std::size_t>(columns * rows), 0);
  column_of_x_.resize(static_cast<std::size_t>(width));
  for (int x = 0; x < width; ++x) column_of_x_[x] = static_cast<std::uint8_t>(x * columns / width);
  const auto cell_of = [&](const Corner& c) -> std::uint8_t& {
    const int row = (c.y - border_px) * rows / height;
    return cell_is_strong_[row * columns + column_of_x_[c.x - border_px]];
  };
  for (std::size_t i = 0; i < count; ++i) {
    cell_of(corners_[i]) |= static_cast<std::uint8_t>(corners_[i].score > threshold);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Corner c = corners_[i];
    const bool keep = c.score > threshold || cell_of(c) == 0;
    corners_[kept] = c;
    kept += keep ? 1 : 0;
  }
  return kept;
}

}  // namespace ydd
