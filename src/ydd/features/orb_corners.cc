// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_corners.h"

#include <algorithm>
#include <array>

#include "ydd/features/simd.h"

namespace ydd {
namespace {

using simd::U8;

using simd::kLanes8;
constexpr int kCell_px = 35;

/// Seven neighbouring rows; the circle's centre lies on row 3.
using Rows = std::array<const std::uint8_t*, 7>;

// The circle, clockwise from the top, as row and column shift. One after the other in memory order
// per row they stay cheap to address: seven row pointers and constants.
struct CirclePixel {
  int row;
  int dx;
};
constexpr std::array<CirclePixel, 16> kCircle = {{{0, 0},
                                                  {0, 1},
                                                  {1, 2},
                                                  {2, 3},
                                                  {3, 3},
                                                  {4, 3},
                                                  {5, 2},
                                                  {6, 1},
                                                  {6, 0},
                                                  {6, -1},
                                                  {5, -2},
                                                  {4, -3},
                                                  {3, -3},
                                                  {2, -3},
                                                  {1, -2},
                                                  {0, -1}}};

// A row of nine among sixteen holds a pixel of every opposite pair. Two pairs decide most of an
// image: a brighter arc needs the brighter pixel of each pair above the centre, and so on.
bool may_hold_corners(const Rows& rows, int x, U8 centre, U8 threshold) {
  const U8 top = simd::load(rows[0] + x);
  const U8 bottom = simd::load(rows[6] + x);
  const U8 right = simd::load(rows[3] + x + 3);
  const U8 left = simd::load(rows[3] + x - 3);
  const U8 bright = simd::min(simd::max(top, bottom), simd::max(left, right));
  const U8 dark = simd::max(simd::min(top, bottom), simd::min(left, right));
  const U8 above = simd::subtract(bright, simd::add(centre, threshold));
  const U8 below = simd::subtract(simd::subtract(centre, threshold), dark);
  return simd::any(simd::bit_or(above, below));
}

// Largest over the sixteen arcs of nine pixels of the arc's smallest. Two arcs that share eight
// pixels differ only in the ninth, so their larger smallest is min(of the eight, max(both ninths)).
template <class Smaller, class Larger>
U8 best_arc(const std::array<U8, 16>& p, Smaller smaller, Larger larger) {
  std::array<U8, 8> two;
  std::array<U8, 8> four;
  for (int i = 0; i < 8; ++i) two[i] = smaller(p[2 * i + 1], p[(2 * i + 2) % 16]);
  for (int i = 0; i < 8; ++i) four[i] = smaller(two[i], two[(i + 1) % 8]);
  U8 best{};
  for (int i = 0; i < 8; ++i) {
    const U8 eight = smaller(four[i], four[(i + 2) % 8]);
    const U8 arc = smaller(eight, larger(p[2 * i], p[(2 * i + 9) % 16]));
    best = i == 0 ? arc : larger(best, arc);
  }
  return best;
}

U8 score_of(const Rows& rows, int x, U8 centre, U8 threshold_plus_one) {
  std::array<U8, 16> p;
  for (int i = 0; i < 16; ++i) p[i] = simd::load(rows[kCircle[i].row] + x + kCircle[i].dx);
  const U8 bright = best_arc(p, simd::min, simd::max);
  const U8 dark = best_arc(p, simd::max, simd::min);
  const U8 score = simd::max(simd::subtract(bright, centre), simd::subtract(centre, dark));
  return simd::bit_and(score, simd::at_least(score, threshold_plus_one));
}

// Writes scores for x in [begin, end), and zero or more behind it up to a whole vector.
void score_row(const Rows& rows, int begin, int end, int threshold, std::uint8_t* scores) {
  const U8 t = simd::splat8(threshold);
  const U8 t_plus_one = simd::splat8(threshold + 1);
  for (int x = begin; x < end; x += kLanes8) {
    const U8 centre = simd::load(rows[3] + x);
    const bool may = may_hold_corners(rows, x, centre, t);
    simd::store(scores + x, may ? score_of(rows, x, centre, t_plus_one) : simd::splat8(0));
  }
}

// Bit i: x + i is a maximum. Strictly above the neighbours that come before it in reading order.
std::uint32_t maxima(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below,
                     int x) {
  const U8 s = simd::load(row + x);
  if (!simd::any(s)) return 0;
  const auto three = [x](const std::uint8_t* r) {
    return simd::max(simd::max(simd::load(r + x - 1), simd::load(r + x)), simd::load(r + x + 1));
  };
  const U8 before = simd::max(three(above), simd::load(row + x - 1));
  const U8 after = simd::max(three(below), simd::load(row + x + 1));
  return simd::top_bits(simd::at_least(s, after)) & ~simd::top_bits(simd::at_least(before, s));
}

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
  const auto row_size = static_cast<std::size_t>(view.width + 2 * kLanes8);
  scores_.assign(3 * row_size, 0);
  std::size_t count = 0;
  for (int y = y_begin - 1; y <= y_end; ++y) {
    Rows rows;
    for (int i = 0; i < 7; ++i) rows[i] = view.row(y + i - 3);
    score_row(rows, x_begin - 1, x_end + 1, low_threshold, &scores_[(y % 3) * row_size]);
    if (y <= y_begin) continue;
    const std::uint8_t* above = &scores_[((y - 2) % 3) * row_size];
    const std::uint8_t* row = &scores_[((y - 1) % 3) * row_size];
    const std::uint8_t* below = &scores_[(y % 3) * row_size];
    if (corners_.size() < count + view.width) corners_.resize(2 * count + 4 * view.width);
    for (int x = x_begin; x < x_end; x += kLanes8) {
      std::uint32_t bits = maxima(above, row, below, x);
      if (x_end - x < kLanes8) bits &= (1U << (x_end - x)) - 1;
      for (; bits != 0; bits &= bits - 1) {
        const int at = x + std::countr_zero(bits);
        corners_[count++] = {static_cast<std::uint16_t>(at), static_cast<std::uint16_t>(y - 1),
                             row[at]};
      }
    }
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
