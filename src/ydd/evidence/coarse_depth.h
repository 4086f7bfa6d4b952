// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/geometry/camera.h"
#include "ydd/image/image.h"

namespace ydd {

/// The cells of an image in which depth is looked at coarsely. Cells on the right and lower border
/// that are cut off are left out.
struct CellGrid {
  int cell_px = 8;
  int columns = 0;
  int rows = 0;
  float per_px = 0.125F;  ///< cells: a product is quicker than a quotient

  CellGrid() = default;
  CellGrid(int width_px, int height_px, int side_px)
      : cell_px(side_px),
        columns(width_px / side_px),
        rows(height_px / side_px),
        per_px(1.0F / static_cast<float>(side_px)) {}

  int cells() const { return columns * rows; }
  bool contains(int column, int row) const {
    return column >= 0 && row >= 0 && column < columns && row < rows;
  }
  int index(int column, int row) const { return row * columns + column; }
  /// The cell of a pixel; may lie outside.
  int cell_of(float px) const { return static_cast<int>(px * per_px); }
  /// Where a cell begins: its corner to the left and above, px.
  Eigen::Vector2f corner_px(std::size_t cell) const {
    const int i = static_cast<int>(cell), row = i / columns;
    return Eigen::Vector2i(i - row * columns, row).cast<float>() * static_cast<float>(cell_px);
  }
  friend bool operator==(const CellGrid&, const CellGrid&) = default;
};

/// A depth image by cells: a reading of each, and how near and far its surroundings reach.
struct CoarseDepth {
  CellGrid grid;
  std::vector<float> z_m;     ///< the middle one of some readings in the cell; 0: none
  std::vector<float> near_m;  ///< least reading in the cell and the eight around it; 0: too few
  std::vector<float> far_m;   ///< largest one; 0: too few
};

/// Depth of the surface at a pixel, interpolated between the cells around it; 0 where they do not
/// show one surface (steps above `step_share` of the depth).
float surface_depth(const CoarseDepth& depth, float x_px, float y_px, float step_share);

CoarseDepth coarse_depth(const DepthImage& depth_m, int cell_px);

/// Directions of the cells' centres: the point of the camera frame at depth 1, lens undone.
std::vector<Eigen::Vector2f> cell_rays(const Camera& camera, const CellGrid& grid);

}  // namespace ydd
