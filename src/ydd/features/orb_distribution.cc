// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/orb_distribution.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ydd {
namespace {

constexpr int kScores = 256;
constexpr int kSearchSteps = 8;
constexpr double kTolerance = 0.03;

std::uint32_t cell_of(std::uint16_t at_px, std::uint32_t cells_per_px_q16) {
  return (at_px * cells_per_px_q16) >> 16;
}

}  // namespace

std::vector<int> level_quotas(int target, double step, std::span<const int> available) {
  std::vector<int> quotas(available.size(), 0);
  int left = target;
  for (bool gave = true; gave && left > 0;) {
    double weight_left = 0.0;
    double weight = 1.0;
    for (std::size_t i = 0; i < quotas.size(); ++i, weight /= step) {
      if (quotas[i] < available[i]) weight_left += weight;
    }
    gave = false;
    weight = 1.0;
    for (std::size_t i = 0; i < quotas.size(); ++i, weight /= step) {
      if (quotas[i] >= available[i]) continue;
      const int share = static_cast<int>(std::lround(left * weight / weight_left));
      const int given = std::min(share, available[i] - quotas[i]);
      weight_left -= weight;
      left -= given;
      quotas[i] += given;
      gave = gave || given > 0;
    }
  }
  return quotas;
}

CornerSelector::Grid CornerSelector::make_grid(double pitch_px, int width_px, int height_px) {
  Grid grid;
  grid.cells_per_px_q16 = static_cast<std::uint32_t>(std::lround(65536.0 / pitch_px));
  const auto cells = [&](int size_px) {
    return static_cast<int>(cell_of(static_cast<std::uint16_t>(size_px), grid.cells_per_px_q16)) +
           1;
  };
  grid.columns = cells(width_px);
  grid.rows = cells(height_px);
  return grid;
}

int CornerSelector::occupied_cells(std::span<const Corner> corners, const Grid& grid) {
  occupied_.assign(static_cast<std::size_t>(grid.columns * grid.rows), 0);
  int count = 0;
  for (const Corner& c : corners) {
    std::uint8_t& cell = occupied_[cell_of(c.y, grid.cells_per_px_q16) * grid.columns +
                                   cell_of(c.x, grid.cells_per_px_q16)];
    count += 1 - cell;
    cell = 1;
  }
  return count;
}

// The number of occupied cells falls with the pitch about as pitch^-1.5; a secant in logarithms
// gets within a few percent in two or three steps. The grid taken holds `count` or a little more.
CornerSelector::Grid CornerSelector::search(std::span<const Corner> corners, int width_px,
                                            int height_px, int count) {
  double too_fine_px = 1.0;  // holds count or more
  double too_coarse_px = std::max(width_px, height_px);
  double pitch_px = std::sqrt(static_cast<double>(width_px) * height_px / count) * 0.8;
  Grid best = make_grid(too_fine_px, width_px, height_px);
  for (int i = 0; i < kSearchSteps; ++i) {
    pitch_px = std::clamp(pitch_px, too_fine_px, too_coarse_px);
    const Grid grid = make_grid(pitch_px, width_px, height_px);
    const int occupied = occupied_cells(corners, grid);
    if (occupied >= count) {
      too_fine_px = pitch_px;
      best = grid;
      if (occupied <= count * (1.0 + kTolerance)) break;
    } else {
      too_coarse_px = pitch_px;
    }
    const double aim = count * (1.0 + kTolerance / 2);
    const double next_px = pitch_px * std::pow(occupied / aim, 1.0 / 1.5);
    const bool inside = next_px > too_fine_px && next_px < too_coarse_px;
    pitch_px = inside ? next_px : std::sqrt(too_fine_px * too_coarse_px);
  }
  return best;
}

void CornerSelector::keep_best_of_cells(std::span<const Corner> corners, const Grid& grid) {
  // Score above, position below such that the first of equal ones is the largest key.
  constexpr std::uint32_t kIndexMask = 0xffffff;
  best_.assign(static_cast<std::size_t>(grid.columns * grid.rows), 0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner& c = corners[i];
    std::uint32_t& cell = best_[cell_of(c.y, grid.cells_per_px_q16) * grid.columns +
                                cell_of(c.x, grid.cells_per_px_q16)];
    const auto key = static_cast<std::uint32_t>(c.score) << 24 |
                     (kIndexMask - (static_cast<std::uint32_t>(i) & kIndexMask));
    cell = std::max(cell, key);
  }
  selected_.clear();
  for (const std::uint32_t key : best_) {
    if (key != 0) selected_.push_back(corners[kIndexMask - (key & kIndexMask)]);
  }
}

void CornerSelector::drop_weakest(std::size_t count) {
  if (selected_.size() <= count) return;
  std::array<std::size_t, kScores> with_score{};
  for (const Corner& c : selected_) ++with_score[c.score];
  std::size_t excess = selected_.size() - count;
  int weakest = 0;
  for (; with_score[weakest] <= excess; ++weakest) excess -= with_score[weakest];
  std::erase_if(selected_, [&](const Corner& c) {
    if (c.score != weakest || excess == 0) return c.score < weakest;
    --excess;
    return true;
  });
}

std::span<const Corner> CornerSelector::select(std::span<const Corner> corners, int width_px,
                                               int height_px, int count) {
  if (count <= 0) return {};
  if (static_cast<std::size_t>(count) >= corners.size()) return corners;
  keep_best_of_cells(corners, search(corners, width_px, height_px, count));
  drop_weakest(static_cast<std::size_t>(count));
  return selected_;
}

}  // namespace ydd
