// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ydd/features/orb_corners.h"

namespace ydd {

/// How many of `target` points each level gets: N_i = N (1 - b) / (1 - b^L) b^i, b = 1 / step,
/// rounded so that they add up to `target`. A level that has fewer points `available` gives what
/// it cannot use to the others, in the same proportion.
std::vector<int> level_quotas(int target, double step, std::span<const int> available);

/// Chooses corners that are spread evenly over an image: the strongest one of each cell of a grid,
/// whose pitch is searched such that the wanted number of cells holds one. Where corners are
/// sparse, all are kept; where they are dense, the grid thins them.
/// Thread: one call at a time.
class CornerSelector {
 public:
  /// min(count, corners.size()) of `corners`, by grid cell. Valid until the next call.
  std::span<const Corner> select(std::span<const Corner> corners, int width_px, int height_px,
                                 int count);

 private:
  struct Grid {
    std::uint32_t cells_per_px_q16 = 0;
    int columns = 0;
    int rows = 0;
  };
  static Grid make_grid(double pitch_px, int width_px, int height_px);
  int occupied_cells(std::span<const Corner> corners, const Grid& grid);
  Grid search(std::span<const Corner> corners, int width_px, int height_px, int count);
  void keep_best_of_cells(std::span<const Corner> corners, const Grid& grid);
  void drop_weakest(std::size_t count);

  std::vector<std::uint8_t> occupied_;
  std::vector<std::uint32_t> best_;
  std::vector<Corner> selected_;
};

}  // namespace ydd
