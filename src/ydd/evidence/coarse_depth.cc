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

/// Readings of the cells of one row, or of several rows together.
struct Row {
  std::vector<float> near_m, far_m, count;
  explicit Row(int columns)
      : near_m(static_cast<std::size_t>(columns)), far_m(near_m.size()), count(near_m.size()) {}
};

/// Each cell with its neighbours left and right.
void widen(const Row& row, Row& out) {
  const std::size_t n = row.near_m.size();
  const auto at = [&](std::size_t i, std::size_t left, std::size_t right) {
    out.near_m[i] = std::min({row.near_m[left], row.near_m[i], row.near_m[right]});
    out.far_m[i] = std::max({row.far_m[left], row.far_m[i], row.far_m[right]});
    out.count[i] =
        row.count[i] + (left < i ? row.count[left] : 0.0F) + (right > i ? row.count[right] : 0.0F);
  };
  if (n == 1) return at(0, 0, 0);
  at(0, 0, 1);
  for (std::size_t i = 1; i + 1 < n; ++i) at(i, i - 1, i + 1);
  at(n - 1, n - 2, n - 1);
}

/// Three rows of widened cells together, as the surroundings of the middle one.
void gather(const Row* above, const Row& middle, const Row* below, float* near_m, float* far_m) {
  const std::size_t n = middle.near_m.size();
  for (std::size_t i = 0; i < n; ++i) {
    float near = middle.near_m[i], far = middle.far_m[i], count = middle.count[i];
    const float columns = n == 1 ? 1.0F : (i == 0 || i + 1 == n) ? 2.0F : 3.0F;
    float asked = kSamples * columns;
    for (const Row* row : {above, below}) {
      if (!row) continue;
      near = std::min(near, row->near_m[i]);
      far = std::max(far, row->far_m[i]);
      count += row->count[i];
      asked += kSamples * columns;
    }
    const bool enough = 2 * count > asked;
    near_m[i] = enough ? near : 0.0F;
    far_m[i] = enough ? far : 0.0F;
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
  std::vector<Row> widened(static_cast<std::size_t>(grid.rows), Row(grid.columns));
  Row readings(grid.columns);
  for (int row = 0; row < grid.rows; ++row) {
    const float* upper = depth_m.row(row * cell_px + low_px);
    const float* lower = depth_m.row(row * cell_px + high_px);
    for (int column = 0; column < grid.columns; ++column) {
      const int x_px = column * cell_px;
      const auto i = static_cast<std::size_t>(column);
      const CellReadings cell = readings_of(upper, lower, x_px + low_px, x_px + high_px);
      out.z_m[static_cast<std::size_t>(grid.index(column, row))] = cell.middle_m;
      readings.near_m[i] = cell.near_m;
      readings.far_m[i] = cell.far_m;
      readings.count[i] = cell.count;
    }
    widen(readings, widened[static_cast<std::size_t>(row)]);
  }
  for (int row = 0; row < grid.rows; ++row) {
    const Row* middle = &widened[static_cast<std::size_t>(row)];
    gather(row > 0 ? middle - 1 : nullptr, *middle, row + 1 < grid.rows ? middle + 1 : nullptr,
           out.near_m.data() + grid.index(0, row), out.far_m.data() + grid.index(0, row));
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
