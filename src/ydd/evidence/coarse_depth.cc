// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/coarse_depth.h"

#include <algorithm>
#include <array>

namespace ydd {
namespace {

constexpr int kSamples = 4;  // of a cell, in a square
constexpr float kFar = 1e9F;

struct CellReadings {
  float middle_m = 0, near_m = kFar, far_m = 0;
  int count = 0;
};

CellReadings readings_of(const DepthImage& depth_m, int x0_px, int y0_px, int cell_px) {
  const int low = cell_px / 4;
  const int high = cell_px - 1 - low;
  std::array<float, kSamples> found{};
  CellReadings out;
  for (const int y : {y0_px + low, y0_px + high}) {
    const float* row = depth_m.row(y);
    for (const int x : {x0_px + low, x0_px + high}) {
      if (row[x] > 0) found[static_cast<std::size_t>(out.count++)] = row[x];
    }
  }
  if (out.count == 0) return out;
  std::sort(found.begin(), found.begin() + out.count);
  out.middle_m = found[static_cast<std::size_t>((out.count - 1) / 2)];
  out.near_m = found[0];
  out.far_m = found[static_cast<std::size_t>(out.count - 1)];
  return out;
}

}  // namespace

CoarseDepth coarse_depth(const DepthImage& depth_m, int cell_px) {
  CoarseDepth out;
  out.grid = CellGrid(depth_m.width(), depth_m.height(), cell_px);
  const CellGrid& grid = out.grid;
  const auto cells = static_cast<std::size_t>(grid.cells());
  std::vector<CellReadings> readings(cells);
  out.z_m.resize(cells);
  out.near_m.resize(cells);
  out.far_m.resize(cells);
  for (int row = 0, i = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column, ++i) {
      const auto cell = static_cast<std::size_t>(i);
      readings[cell] = readings_of(depth_m, column * cell_px, row * cell_px, cell_px);
      out.z_m[cell] = readings[cell].middle_m;
    }
  }
  for (int row = 0, i = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column, ++i) {
      float near_m = kFar;
      float far_m = 0;
      int count = 0;
      int asked = 0;
      for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r) {
        for (int c = std::max(0, column - 1); c <= std::min(grid.columns - 1, column + 1); ++c) {
          const CellReadings& around = readings[static_cast<std::size_t>(grid.index(c, r))];
          near_m = std::min(near_m, around.near_m);
          far_m = std::max(far_m, around.far_m);
          count += around.count;
          asked += kSamples;
        }
      }
      const bool enough = 2 * count > asked;
      out.near_m[static_cast<std::size_t>(i)] = enough ? near_m : 0.0F;
      out.far_m[static_cast<std::size_t>(i)] = enough ? far_m : 0.0F;
    }
  }
  return out;
}

float surface_depth(const CoarseDepth& depth, float x_px, float y_px, float step_share) {
  const CellGrid& grid = depth.grid;
  const float c = (x_px + 0.5F) * grid.per_px - 0.5F;
  const float r = (y_px + 0.5F) * grid.per_px - 0.5F;
  if (!(c >= 0 && r >= 0)) return 0;
  const int column = static_cast<int>(c), row = static_cast<int>(r);
  if (column + 1 >= grid.columns || row + 1 >= grid.rows) return 0;
  const float* z = depth.z_m.data() + grid.index(column, row);
  const float* below = z + grid.columns;
  const float least = std::min({z[0], z[1], below[0], below[1]});
  const float most = std::max({z[0], z[1], below[0], below[1]});
  if (least <= 0 || most - least > 2 * step_share * least) return 0;
  const float fx = c - static_cast<float>(column), fy = r - static_cast<float>(row);
  return (1 - fy) * ((1 - fx) * z[0] + fx * z[1]) + fy * ((1 - fx) * below[0] + fx * below[1]);
}

std::vector<Eigen::Vector2f> cell_rays(const Camera& camera, const CellGrid& grid) {
  std::vector<Eigen::Vector2f> rays;
  rays.reserve(static_cast<std::size_t>(grid.cells()));
  const double half_px = 0.5 * (grid.cell_px - 1);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const Eigen::Vector2d px =
          camera.undistort({column * grid.cell_px + half_px, row * grid.cell_px + half_px});
      rays.push_back(camera.unproject(px, 1.0).head<2>().cast<float>());
    }
  }
  return rays;
}

}  // namespace ydd
