// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ydd/features/orb_kernels.h"

namespace ydd {
namespace {

constexpr int kWeightOne = 128;

int round_up(int n, int multiple) { return (n + multiple - 1) / multiple * multiple; }

/// Where a pixel of the smaller image lies in the larger one.
struct Position {
  int index = 0;   ///< of the left (upper) of two neighbours
  int weight = 0;  ///< of the right (lower) one, in 1/128
};

// Both weights stay within 1 to 127, as the 8-bit signed multiplication asks for.
Position source_of(int i, double step, int source_size) {
  const double at = (i + 0.5) * step - 0.5;
  const int index = std::clamp(static_cast<int>(std::floor(at)), 0, source_size - 2);
  const int weight = static_cast<int>(std::lround((at - index) * kWeightOne));
  return {index, std::clamp(weight, 1, kWeightOne - 1)};
}

}  // namespace

OrbPyramid::OrbPyramid(int levels, double step, int min_size_px)
    : max_levels_(levels), step_(step), min_size_px_(std::max(min_size_px, 16)) {}

void OrbPyramid::allocate(int width_px, int height_px) {
  levels_.clear();
  views_.clear();
  int width = width_px;
  int height = height_px;
  for (int l = 0; l < max_levels_ && std::min(width, height) >= min_size_px_; ++l) {
    Level level;
    GreyView view{nullptr, width, height, width};
    if (l > 0) {
      const GreyView& from = views_.back();
      // Odd multiple of a cache line, so that the rows of a patch do not share a cache set.
      view.stride = round_up(width + kOrbVector_px, 64) | 64;
      level.pixels.resize(static_cast<std::size_t>(view.stride * height) + kOrbVector_px);
      level.columns.resize(static_cast<std::size_t>(round_up(width, kOrbVector_px) / 8));
      for (int x = 0; x < static_cast<int>(level.columns.size()) * 8; ++x) {
        ShrunkEight& eight = level.columns[x / 8];
        const Position at = source_of(x, step_, from.width);
        if (x % 8 == 0) eight.first = std::min(at.index, from.width - 16);
        const int k = 2 * (x % 8);
        eight.index[k] = static_cast<std::uint8_t>(std::min(at.index - eight.first, 14));
        eight.index[k + 1] = static_cast<std::uint8_t>(eight.index[k] + 1);
        eight.weight[k] = static_cast<std::uint8_t>(kWeightOne - at.weight);
        eight.weight[k + 1] = static_cast<std::uint8_t>(at.weight);
      }
    }
    levels_.push_back(std::move(level));
    views_.push_back(view);
    if (l > 0) views_.back().pixels = levels_.back().pixels.data();
    width = static_cast<int>(width / step_);
    height = static_cast<int>(height / step_);
  }
  for (auto& row : rows_)
    row.assign(static_cast<std::size_t>(round_up(width_px, kOrbVector_px)), 0);
}

std::span<const GreyView> OrbPyramid::build(const GreyImage& grey) {
  const bool same_size =
      !views_.empty() && views_[0].width == grey.width() && views_[0].height == grey.height();
  if (!same_size) allocate(grey.width(), grey.height());
  if (views_.empty()) return {};
  views_[0].pixels = grey.data();
  for (std::size_t l = 1; l < views_.size(); ++l) {
    shrink(views_[l - 1], levels_[l], views_[l], levels_[l].pixels.data());
  }
  return views_;
}

void OrbPyramid::shrink(const GreyView& from, const Level& level, const GreyView& to,
                        std::uint8_t* to_pixels) {
  const int padded_width = static_cast<int>(level.columns.size()) * 8;
  const OrbKernels& kernels = orb_kernels();
  std::array<int, 2> row_held = {-1, -1};  // row i is held in rows_[i % 2]
  for (int y = 0; y < to.height; ++y) {
    const Position at = source_of(y, step_, from.height);
    for (int i = at.index; i <= at.index + 1; ++i) {
      if (row_held[i % 2] != i) {
        kernels.shrink_row(from.row(i), level.columns.data(), level.columns.size(),
                           rows_[i % 2].data());
      }
      row_held[i % 2] = i;
    }
    kernels.blend_rows(rows_[at.index % 2].data(), rows_[(at.index + 1) % 2].data(), at.weight,
                       padded_width, to_pixels + y * to.stride);
  }
}

}  // namespace ydd
