// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/coarse_depth.h"

#include <algorithm>
#include <array>

namespace ydd {
namespace {

constexpr int kSamples = 4;  // of a cell, in a square
constexpr float kFar = 1e9F;

struct CellReadings {
  float middle_m = 0, near_m = kFar, far_m = 0, count = 0;
};

/// What the cell's samples read; the sorting has no branches, since holes come at random.
CellReadings readings_of(const float* upper, const float* lower, int left_px, int right_px) {
  std::array<float, kSamples> z = {upper[left_px], upper[right_px], lower[left_px],
                                   lower[right_px]};
  int count = 0;
  for (float& reading : z) {
    count += reading > 0 ? 1 : 0;
    reading = reading > 0 ? reading : kFar;
  }
  const auto in_order = [&](std::size_t a, std::size_t b) {
    const float least = std::min(z[a], z[b]);
    z[b] = std::max(z[a], z[b]);
    z[a] = least;
  };
  in_order(0, 1), in_order(2, 3), in_order(0, 2), in_order(1, 3), in_order(1, 2);
  if (count == 0) return {};
  const auto last = static_cast<std::size_t>(count - 1);
  return {z[last / 2], z[0], z[last], static_cast<float>(count)};
}

/// Readings of cells: parallel arrays.
struct Cells {
  std::vector<float> near_m, far_m, count;
  explicit Cells(int cells)
      : near_m(static_cast<std::size_t>(cells)), far_m(near_m.size()), count(near_m.size()) {}
};

/// A row of cells, each with its neighbours left and right; `first` is where it begins in `out`.
void widen(const Cells& row, std::size_t first, Cells& out) {
  const std::size_t n = row.near_m.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t left = i == 0 ? 0 : i - 1, right = i + 1 == n ? i : i + 1;
    out.near_m[first + i] = std::min({row.near_m[left], row.near_m[i], row.near_m[right]});
    out.far_m[first + i] = std::max({row.far_m[left], row.far_m[i], row.far_m[right]});
    out.count[first + i] =
        row.count[i] + (left < i ? row.count[left] : 0.0F) + (right > i ? row.count[right] : 0.0F);
  }
}

/// The surroundings of each cell: its row's widened cells with those above and below.
void gather(const Cells& widened, CoarseDepth& out) {
  const CellGrid& grid = out.grid;
  for (int row = 0; row < grid.rows; ++row) {
    const int above = std::max(0, row - 1), below = std::min(grid.rows - 1, row + 1);
    for (int column = 0; column < grid.columns; ++column) {
      float near_m = kFar, far_m = 0, count = 0;
      for (int r = above; r <= below; ++r) {
        const auto i = static_cast<std::size_t>(grid.index(column, r));
        near_m = std::min(near_m, widened.near_m[i]);
        far_m = std::max(far_m, widened.far_m[i]);
        count += widened.count[i];
      }
      const int beside = std::min(grid.columns - 1, column + 1) - std::max(0, column - 1) + 1;
      const bool enough = 2 * count > static_cast<float>(kSamples * beside * (below - above + 1));
      const auto cell = static_cast<std::size_t>(grid.index(column, row));
      out.near_m[cell] = enough ? near_m : 0.0F;
      out.far_m[cell] = enough ? far_m : 0.0F;
    }
  }
}

}  // namespace

CoarseDepth coarse_depth(const DepthImage& depth_m, int cell_px) {
  CoarseDepth out;
  out.grid = CellGrid(depth_m.width(), depth_m.height(), cell_px);
  const CellGrid& grid = out.grid;
  for (std::vector<float>* v : {&out.z_m, &out.near_m, &out.far_m}) {
    v->resize(static_cast<std::size_t>(grid.cells()));
  }
  const int low_px = cell_px / 4, high_px = cell_px - 1 - low_px;
  Cells widened(grid.cells()), readings(grid.columns);
  for (int row = 0; row < grid.rows; ++row) {
    const float* upper = depth_m.row(row * cell_px + low_px);
    const float* lower = depth_m.row(row * cell_px + high_px);
    const auto first = static_cast<std::size_t>(grid.index(0, row));
    for (int column = 0; column < grid.columns; ++column) {
      const int x_px = column * cell_px;
      const auto i = static_cast<std::size_t>(column);
      const CellReadings cell = readings_of(upper, lower, x_px + low_px, x_px + high_px);
      out.z_m[first + i] = cell.middle_m;
      readings.near_m[i] = cell.near_m;
      readings.far_m[i] = cell.far_m;
      readings.count[i] = cell.count;
    }
    widen(readings, first, widened);
  }
  gather(widened, out);
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
