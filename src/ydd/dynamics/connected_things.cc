// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/connected_things.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace ydd {
namespace {

struct Cell {
  int column, row;
};
constexpr std::array<Cell, 4> kNeighbours = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

/// A depth image at a coarse step, read where it is looked at: most of it never is.
class DepthGrid {
 public:
  DepthGrid(const DepthImage& depth_m, int cell_px)
      : depth_m_(depth_m),
        cell_px_(cell_px),
        columns_(depth_m.width() / cell_px),
        rows_(depth_m.height() / cell_px),
        readings_(static_cast<std::size_t>(columns_) * rows_, kUnread) {}

  int cell_px() const { return cell_px_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  bool contains(const Cell& c) const {
    return c.column >= 0 && c.row >= 0 && c.column < columns_ && c.row < rows_;
  }
  std::size_t index(const Cell& c) const {
    return static_cast<std::size_t>(c.row) * columns_ + c.column;
  }
  float at(const Cell& c) {
    float& reading = readings_[index(c)];
    if (reading == kUnread) {
      reading = cell_reading(depth_m_, c.column * cell_px_, c.row * cell_px_, cell_px_);
    }
    return reading;
  }

 private:
  static constexpr float kUnread = -1.0F;
  const DepthImage& depth_m_;
  int cell_px_, columns_, rows_;
  std::vector<float> readings_;
};

/// The cells whose centre lies in a box, [first, last).
struct CellRect {
  int column0, row0, column1, row1;
  bool contains(const Cell& c) const {
    return c.column >= column0 && c.column < column1 && c.row >= row0 && c.row < row1;
  }
};

CellRect cells_of(const DepthGrid& grid, const Box& box) {
  const auto first = [&](float px, int count) {
    const auto k = static_cast<int>(std::ceil(px / static_cast<float>(grid.cell_px()) - 0.5F));
    return std::clamp(k, 0, count);
  };
  return {first(box.x0, grid.columns()), first(box.y0, grid.rows()), first(box.x1, grid.columns()),
          first(box.y1, grid.rows())};
}

/// A surface while it is followed.
struct Surface {
  std::vector<Cell> cells;
  bool bounded = true;  ///< ends inside the window
};

/// Follows surfaces outside the boxes of bodies.
class Follower {
 public:
  Follower(DepthGrid& grid, std::span<const CellRect> bodies, double step_share)
      : grid_(grid),
        step_share_(step_share),
        owner_(static_cast<std::size_t>(grid.columns()) * grid.rows(), kOpen) {
    for (std::size_t body = 0; body < bodies.size(); ++body) {
      for (int row = bodies[body].row0; row < bodies[body].row1; ++row) {
        const auto begin = owner_.begin() + row * grid.columns();
        std::fill(begin + bodies[body].column0, begin + bodies[body].column1,
                  static_cast<int>(body));
      }
    }
  }

  /// The surface in `range` that goes on from cell `from`, inside the box of `body`, into its
  /// neighbour `start`; empty when it does not, or when it was followed before.
  Surface follow(int body, const Cell& from, const Cell& start, const DepthRange& range,
                 const CellRect& window) {
    Surface surface;
    if (!range.contains(at(from))) return surface;
    take(body, from, start, range, surface);
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
      const Cell cell = surface.cells[i];
      if (!window.contains(cell)) {
        surface.bounded = false;  // and no further: what lies beyond is of no interest
        continue;
      }
      for (const auto& [dc, dr] : kNeighbours) {
        take(body, cell, {cell.column + dc, cell.row + dr}, range, surface);
      }
    }
    return surface;
  }

 private:
  static constexpr int kOpen = -1;
  static constexpr int kFollowed = -2;

  float at(const Cell& cell) { return grid_.at(cell); }

  /// A surface that goes on, but out of the depth range or into another body's box, has no end
  /// there.
  void take(int body, const Cell& from, const Cell& to, const DepthRange& range, Surface& surface) {
    if (!grid_.contains(to) || !continuous(at(from), at(to), step_share_)) return;
    int& owner = owner_[grid_.index(to)];
    if (owner == kFollowed || owner == body) return;
    if (owner != kOpen || !range.contains(at(to))) {
      surface.bounded = false;
      return;
    }
    owner = kFollowed;
    surface.cells.push_back(to);
  }

  DepthGrid& grid_;
  double step_share_;
  std::vector<int> owner_;  ///< of each cell: the body in whose box it lies, open, or followed
};

MovingRegion region_of(DepthGrid& grid, const Surface& surface, int object, double margin_share) {
  Cell low = surface.cells.front();
  Cell high = low;
  DepthRange range{grid.at(low), grid.at(low)};
  for (const Cell& cell : surface.cells) {
    low = {std::min(low.column, cell.column), std::min(low.row, cell.row)};
    high = {std::max(high.column, cell.column), std::max(high.row, cell.row)};
    const float d = grid.at(cell);
    range = joined(range, {d, d});
  }
  const auto margin = static_cast<float>(margin_share);
  const auto px = [&](int cells) { return static_cast<float>(cells * grid.cell_px()); };
  return {object,
          Rule::connected,
          {px(low.column), px(low.row), px(high.column + 1), px(high.row + 1)},
          DepthRange{range.min_m * (1 - margin), range.max_m * (1 + margin)}};
}

/// Pairs of neighbouring cells across the border of a box: inside, outside.
std::vector<std::pair<Cell, Cell>> border_of(const CellRect& rect) {
  std::vector<std::pair<Cell, Cell>> pairs;
  for (int row = rect.row0; row < rect.row1; ++row) {
    pairs.push_back({{rect.column0, row}, {rect.column0 - 1, row}});
    pairs.push_back({{rect.column1 - 1, row}, {rect.column1, row}});
  }
  for (int column = rect.column0; column < rect.column1; ++column) {
    pairs.push_back({{column, rect.row0}, {column, rect.row0 - 1}});
    pairs.push_back({{column, rect.row1 - 1}, {column, rect.row1}});
  }
  return pairs;
}

}  // namespace

float cell_reading(const DepthImage& depth_m, int x0_px, int y0_px, int cell_px) {
  const int half = cell_px / 2;
  const int inset = cell_px / 4;
  const int far = cell_px - 1 - inset;
  const std::array<Cell, 5> samples = {
      {{half, half}, {inset, inset}, {far, inset}, {inset, far}, {far, far}}};
  for (const auto& [dx, dy] : samples) {
    const float d = depth_m(x0_px + dx, y0_px + dy);
    if (d > 0.0F && std::isfinite(d)) return d;
  }
  return 0.0F;
}

bool continuous(float a_m, float b_m, double step_share) {
  return a_m > 0.0F && b_m > 0.0F && std::abs(a_m - b_m) < step_share * std::min(a_m, b_m);
}

std::vector<MovingRegion> connected_things(const DepthImage& depth_m,
                                           std::span<const MovingRegion> bodies,
                                           const ConnectedObjectOptions& options) {
  if (bodies.empty()) return {};
  DepthGrid grid(depth_m, options.cell_px);
  std::vector<CellRect> rects;
  for (const MovingRegion& body : bodies) rects.push_back(cells_of(grid, body.box));
  Follower follower(grid, rects, options.step_share);
  std::vector<MovingRegion> things;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].range || rects[i].column0 >= rects[i].column1 ||
        rects[i].row0 >= rects[i].row1) {
      continue;
    }
    const DepthRange range = *bodies[i].range;
    const double middle_m = std::max(0.3, (range.min_m + range.max_m) / 2.0);
    const double reach_px = options.reach_m * options.focal_share * depth_m.width() / middle_m;
    const CellRect window = cells_of(grid, grown(bodies[i].box, static_cast<float>(reach_px)));
    for (const auto& [inside, outside] : border_of(rects[i])) {
      const Surface surface = follower.follow(static_cast<int>(i), inside, outside, range, window);
      if (surface.bounded && static_cast<int>(surface.cells.size()) >= options.least_cells) {
        things.push_back(region_of(grid, surface, bodies[i].object, options.step_share));
      }
    }
  }
  return things;
}

}  // namespace ydd
