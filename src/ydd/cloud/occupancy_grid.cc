// SPDX-License-Identifier: Apache-2.0
#include "ydd/cloud/occupancy_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "ydd/geometry/world_up.h"

namespace ydd {
namespace {

constexpr int kSlices = 16;           // of the height between the limits
constexpr int kLayers = kSlices + 1;  // layer 0 is the floor
constexpr std::int8_t kHit = 4, kPass = 1, kMost = 20, kLeast = -6;
// Whoever looks across a table has not seen that there is none: only low slices, those where most
// of what stands on a floor begins, make a cell free whose floor was not seen.
constexpr int kLowSlices = 6, kSeenThrough = 3;
constexpr std::size_t kMostCells = 64'000'000;

/// Likelihoods of all cells and layers, and which were touched by the keyframe of now.
class Columns {
 public:
  Columns(double resolution_m, const GridOptions& options, const Eigen::Vector2d& low_m,
          int columns, int rows)
      : resolution_m_(resolution_m),
        options_(options),
        low_m_(low_m),
        columns_(columns),
        rows_(rows),
        belief_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)),
        known_(belief_.size()) {}

  /// What one keyframe saw.
  void add(const Eigen::Vector3d& from, const std::vector<Eigen::Vector3d>& points) {
    hits_.clear();
    passes_.clear();
    for (const Eigen::Vector3d& p : points) {
      const int layer = layer_of(p.z());
      const std::int64_t cell = cell_of(p);
      if (cell < 0) continue;
      if (layer >= 0) hits_.push_back(cell * kLayers + layer);
    }
    make_unique(hits_);
    for (const Eigen::Vector3d& p : ends_of(points)) trace(from, p);
    make_unique(passes_);
    // What was hit by one ray of a keyframe is not erased by another that grazes it.
    std::vector<std::int64_t> only;
    std::set_difference(passes_.begin(), passes_.end(), hits_.begin(), hits_.end(),
                        std::back_inserter(only));
    for (const std::int64_t i : only) change(i, -kPass);
    for (const std::int64_t i : hits_) change(i, i % kLayers == 0 ? -kHit : kHit);
  }

  Cell state(int column, int row) const {
    const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                   static_cast<std::size_t>(column);
    if (!known_[i]) return Cell::unknown;
    const auto& belief = belief_[i];
    int through = 0;
    for (int layer = 1; layer < kLayers; ++layer) {
      const std::int8_t value = belief[static_cast<std::size_t>(layer)];
      if (value > 0) return Cell::occupied;
      through += layer <= kLowSlices && value < 0 ? 1 : 0;
    }
    return belief[0] < 0 || through >= kSeenThrough ? Cell::vacant : Cell::unknown;
  }
  int columns() const { return columns_; }
  int rows() const { return rows_; }

 private:
  static void make_unique(std::vector<std::int64_t>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
  }

  /// 0: the floor; -1: higher or lower than what matters.
  int layer_of(double height_m) const {
    if (height_m < options_.min_height_m) return height_m > -options_.min_height_m ? 0 : -1;
    if (height_m >= options_.max_height_m) return -1;
    const double share =
        (height_m - options_.min_height_m) / (options_.max_height_m - options_.min_height_m);
    return 1 + std::min(kSlices - 1, static_cast<int>(share * kSlices));
  }

  std::int64_t cell_of(const Eigen::Vector3d& p) const {
    const double x = (p.x() - low_m_.x()) / resolution_m_, y = (p.y() - low_m_.y()) / resolution_m_;
    if (!(x >= 0 && y >= 0 && x < columns_ && y < rows_)) return -1;
    return static_cast<std::int64_t>(y) * columns_ + static_cast<std::int64_t>(x);
  }

  void change(std::int64_t index, int by) {
    const auto cell = static_cast<std::size_t>(index / kLayers);
    std::int8_t& value = belief_[cell][static_cast<std::size_t>(index % kLayers)];
    value = static_cast<std::int8_t>(std::clamp<int>(value + by, kLeast, kMost));
    known_[cell] = 1;
  }

  /// One point of each cell and layer is enough for a ray.
  std::vector<Eigen::Vector3d> ends_of(const std::vector<Eigen::Vector3d>& points) const {
    std::vector<std::pair<std::int64_t, std::size_t>> keys;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::int64_t cell = cell_of(points[i]);
      if (cell < 0) continue;
      keys.emplace_back(cell * (kLayers + 1) + layer_of(points[i].z()) + 1, i);
    }
    std::sort(keys.begin(), keys.end());
    std::vector<Eigen::Vector3d> out;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (i == 0 || keys[i].first != keys[i - 1].first) out.push_back(points[keys[i].second]);
    }
    return out;
  }

  /// Everything before the end is seen through; steps of half a cell.
  void trace(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d way = to - from;
    const double length_m = way.head<2>().norm();
    const int steps = static_cast<int>((length_m - resolution_m_) / (0.5 * resolution_m_));
    const Eigen::Vector3d step = way * (0.5 * resolution_m_ / std::max(length_m, 1e-9));
    std::int64_t last = -1;
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector3d p = from + i * step;
      const int layer = layer_of(p.z());
      const std::int64_t cell = layer > 0 ? cell_of(p) : -1;
      if (cell < 0) continue;
      const std::int64_t index = cell * kLayers + layer;
      if (index != last) passes_.push_back(index);
      last = index;
    }
  }

  double resolution_m_;
  const GridOptions& options_;
  Eigen::Vector2d low_m_;
  int columns_, rows_;
  std::vector<std::array<std::int8_t, kLayers>> belief_;  ///< above 0: taken
  std::vector<std::uint8_t> known_;
  std::vector<std::int64_t> hits_, passes_;  ///< of one keyframe: cell * kLayers + layer
};

/// Cut to what is known, with a border of one cell.
OccupancyGrid cut(const Columns& all, const Eigen::Vector2d& low_m, const GridOptions& options) {
  int x0 = all.columns(), y0 = all.rows(), x1 = -1, y1 = -1;
  for (int y = 0; y < all.rows(); ++y) {
    for (int x = 0; x < all.columns(); ++x) {
      if (all.state(x, y) == Cell::unknown) continue;
      x0 = std::min(x0, x), x1 = std::max(x1, x);
      y0 = std::min(y0, y), y1 = std::max(y1, y);
    }
  }
  OccupancyGrid grid;
  grid.resolution_m = options.resolution_m;
  if (x1 < 0) return grid;
  x0 = std::max(0, x0 - 1), y0 = std::max(0, y0 - 1);
  x1 = std::min(all.columns() - 1, x1 + 1), y1 = std::min(all.rows() - 1, y1 + 1);
  grid.columns = x1 - x0 + 1;
  grid.rows = y1 - y0 + 1;
  grid.origin_m = low_m + options.resolution_m * Eigen::Vector2d(x0, y0);
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) grid.cells.push_back(all.state(x, y));
  }
  return grid;
}

/// Whether the cell lies in a gap between two occupied ones, along one direction.
bool in_gap(const OccupancyGrid& grid, int x, int y, int dx, int dy, int most) {
  const auto to_obstacle = [&](int sign) {
    for (int k = 1; k <= most; ++k) {
      const int column = x + sign * k * dx, row = y + sign * k * dy;
      if (column < 0 || row < 0 || column >= grid.columns || row >= grid.rows) break;
      if (grid.at(column, row) == Cell::occupied) return k;
    }
    return most + 1;
  };
  return to_obstacle(1) + to_obstacle(-1) <= most + 1;
}

/// No robot fits through a narrow gap, and a table that was looked at across has only stripes.
OccupancyGrid without_gaps(OccupancyGrid grid, double most_m) {
  const int most = static_cast<int>(most_m / grid.resolution_m + 1e-6);
  const OccupancyGrid before = grid;
  for (int y = 0; y < grid.rows; ++y) {
    for (int x = 0; x < grid.columns; ++x) {
      const bool gap = in_gap(before, x, y, 1, 0, most) || in_gap(before, x, y, 0, 1, most) ||
                       in_gap(before, x, y, 1, 1, most) || in_gap(before, x, y, 1, -1, most);
      if (gap) grid.cells[static_cast<std::size_t>(y) * grid.columns + x] = Cell::occupied;
    }
  }
  return grid;
}

struct Reach {
  Eigen::Vector2d low_m = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector2d high_m = Eigen::Vector2d::Constant(std::numeric_limits<double>::lowest());
};

/// Nothing lies farther from a keyframe than it can see.
Reach reach_of(const Atlas& atlas, MapId map, const SE3& T_grid_world, double far_m) {
  Reach out;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    if (keyframe.map != map) return;
    const Eigen::Vector2d at = (T_grid_world * keyframe.T_world_camera.translation()).head<2>();
    const Eigen::Vector2d far = Eigen::Vector2d::Constant(far_m);
    out.low_m = out.low_m.cwiseMin(at - far);
    out.high_m = out.high_m.cwiseMax(at + far);
  });
  return out;
}

}  // namespace

Result<FloorPlane> floor_of_map(const Atlas& atlas, MapId map, const DenseCloudOptions& options) {
  constexpr std::size_t kEvery = 7;  // of the points: a floor has many
  std::vector<Eigen::Vector3f> points;
  const auto add = [&](const KeyframeCloud& cloud) {
    for (std::size_t i = 0; i < cloud.points.size(); i += kEvery) {
      points.push_back(cloud.points[i].p_world);
    }
  };
  if (auto r = for_each_keyframe_cloud(atlas, map, options, add); !r) return r.error();
  std::vector<SE3> cameras;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    if (keyframe.map == map) cameras.push_back(keyframe.T_world_camera);
  });
  return find_floor(points, world_up(cameras));
}

Result<OccupancyGrid> occupancy_grid(const Atlas& atlas, MapId map, const SE3& T_grid_world,
                                     const GridOptions& options) {
  // The diagonal of a picture is farther than the depth along its axis.
  const Reach reach = reach_of(atlas, map, T_grid_world, 1.5 * options.cloud.max_depth_m);
  OccupancyGrid none;
  none.resolution_m = options.resolution_m;
  none.T_grid_world = T_grid_world;
  if (!(reach.low_m.x() < reach.high_m.x())) return none;
  // Cells begin at whole multiples of their edge, so that grids of one map fit onto each other.
  const Eigen::Vector2d low_m =
      options.resolution_m * (reach.low_m / options.resolution_m).array().floor().matrix();
  const Eigen::Vector2d cells = (reach.high_m - low_m) / options.resolution_m;
  if (cells.x() * cells.y() > static_cast<double>(kMostCells)) {
    return Error{fmt::format("a grid of {:.0f} x {:.0f} cells is too large; choose larger cells",
                             cells.x(), cells.y())};
  }
  Columns columns(options.resolution_m, options, low_m, static_cast<int>(cells.x()) + 1,
                  static_cast<int>(cells.y()) + 1);
  const auto add = [&](const KeyframeCloud& cloud) {
    std::vector<Eigen::Vector3d> points;
    points.reserve(cloud.points.size());
    for (const CloudPoint& p : cloud.points) {
      points.push_back(T_grid_world * p.p_world.cast<double>());
    }
    columns.add(T_grid_world * cloud.origin.cast<double>(), points);
  };
  if (auto r = for_each_keyframe_cloud(atlas, map, options.cloud, add); !r) return r.error();
  OccupancyGrid grid = without_gaps(cut(columns, low_m, options), options.closed_gap_m);
  grid.T_grid_world = T_grid_world;
  return grid;
}

std::string format_pgm(const OccupancyGrid& grid) {
  std::string out =
      fmt::format("P5\n# {} m/cell\n{} {}\n255\n", grid.resolution_m, grid.columns, grid.rows);
  for (int row = grid.rows - 1; row >= 0; --row) {
    for (int column = 0; column < grid.columns; ++column) {
      const Cell cell = grid.at(column, row);
      const int grey = cell == Cell::occupied ? 0 : cell == Cell::vacant ? 254 : 205;
      out.push_back(static_cast<char>(grey));
    }
  }
  return out;
}

std::string format_map_yaml(const OccupancyGrid& grid, const std::string& image) {
  const Eigen::Vector3d t = grid.T_grid_world.translation();
  const Eigen::Quaterniond q = grid.T_grid_world.rotation();
  std::string quoted;  // a name may hold anything
  for (const char c : image) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return fmt::format(
      "image: '{}'\nresolution: {}\norigin: [{:.6f}, {:.6f}, 0.0]\nnegate: 0\n"
      "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
      "# Poses of the map's world in this frame (z up, floor at 0): tx ty tz qx qy qz qw\n"
      "# T_grid_world: [{:.6f}, {:.6f}, {:.6f}, {:.9f}, {:.9f}, {:.9f}, {:.9f}]\n",
      quoted, grid.resolution_m, grid.origin_m.x(), grid.origin_m.y(), t.x(), t.y(), t.z(), q.x(),
      q.y(), q.z(), q.w());
}

}  // namespace ydd
