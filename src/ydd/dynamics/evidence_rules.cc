// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/evidence_rules.h"

#include <algorithm>
#include <array>

#include "ydd/dynamics/object_depth.h"

namespace ydd {
namespace {

constexpr float kPersonMoves = 1.5F;   // more than four times out of five
constexpr float kThingMoves = 0.7F;    // two times out of three, where a rule says so
constexpr float kMovingShare = 0.15F;  // of a region: a typing person's arms
constexpr float kMostlyMoves = 0.5F;   // of a region
constexpr float kCalm_s = 0.5F;        // of a region that stands still, ...
constexpr float kLongCalm_s = 0.7F;    // ... of a surface that does, inside a region that moves
constexpr float kSurelyStill = -3.0F;

/// Whether what is seen in a cell belongs to the region.
bool covers(const MovingRegion& region, const CellGrid& grid, int column, int row, float z_m) {
  if (region.mask.empty()) return !region.range || region.range->contains(z_m);
  const auto side_px = static_cast<float>(grid.cell_px);
  return region.on_mask((static_cast<float>(column) + 0.5F) * side_px,
                        (static_cast<float>(row) + 0.5F) * side_px);
}

/// Calls `visit(cell)` for the cells with a reading in the region.
template <class Visit>
void for_cells(const MovingRegion& region, const MotionOdds& odds, Visit&& visit) {
  const CellGrid& grid = odds.depth.grid;
  const int first_column = std::max(0, grid.cell_of(region.box.x0));
  const int first_row = std::max(0, grid.cell_of(region.box.y0));
  const int last_column = std::min(grid.columns - 1, grid.cell_of(region.box.x1));
  const int last_row = std::min(grid.rows - 1, grid.cell_of(region.box.y1));
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const auto cell = static_cast<std::size_t>(grid.index(column, row));
      const float z_m = odds.depth.z_m[cell];
      if (z_m > 0 && covers(region, grid, column, row, z_m)) visit(cell);
    }
  }
}

}  // namespace

float prior_log_odds(Rule rule) {
  switch (rule) {
    case Rule::body_depth:
    case Rule::bridged:
    case Rule::lone_part:
    case Rule::around_hand:
      return kPersonMoves;
    default:
      return kThingMoves;
  }
}

std::vector<float> prior_of_cells(std::span<const MovingRegion> regions, const MotionOdds& odds) {
  std::vector<float> prior(odds.log_odds.size(), 0.0F);
  for (const MovingRegion& region : regions) {
    const float presumed = prior_log_odds(region.rule);
    for_cells(region, odds, [&](std::size_t i) { prior[i] = std::max(prior[i], presumed); });
  }
  return prior;
}

RegionOdds region_odds(const MovingRegion& region, const MotionOdds& odds) {
  RegionOdds out;
  for_cells(region, odds, [&](std::size_t i) {
    ++out.cells;
    out.log_odds += odds.log_odds[i];
    out.calm_s += odds.calm_s[i];
    out.moving_share += odds.moves[i];
  });
  if (out.cells == 0) return out;
  const auto cells = static_cast<float>(out.cells);
  out.log_odds /= cells;
  out.calm_s /= cells;
  out.moving_share /= cells;
  return out;
}

bool is_seen_to_move(const RegionOdds& found) { return found.moving_share >= kMostlyMoves; }

bool stands_still(const RegionOdds& found, Rule rule) {
  return found.cells > 0 && found.moving_share <= kMovingShare && found.calm_s >= kCalm_s &&
         found.log_odds + prior_log_odds(rule) < 0;
}

bool stands_still(const PointSample& point, const MotionOdds& odds) {
  if (point.depth_m <= 0) return false;
  const int cell = odds.cell_at(point.x_px, point.y_px, point.depth_m);
  if (cell < 0) return false;
  const auto i = static_cast<std::size_t>(cell);
  return odds.log_odds[i] < kSurelyStill && odds.calm_s[i] >= kLongCalm_s;
}

Rule evidence_rule(const PointSample& point, const MotionOdds& odds, const DepthImage& depth_m,
                   float edge_radius_px) {
  const auto moves = [&](float x_px, float y_px, float z_m) {
    const int cell = odds.cell_at(x_px, y_px, z_m);
    return cell >= 0 && odds.moves[static_cast<std::size_t>(cell)] != 0;
  };
  if (moves(point.x_px, point.y_px, point.depth_m)) return Rule::seen_moving;
  if (edge_radius_px <= 0) return Rule::kept;
  constexpr std::array<std::array<float, 2>, 4> kSides = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  for (const auto& [dx, dy] : kSides) {
    const float x_px = point.x_px + dx * edge_radius_px;
    const float y_px = point.y_px + dy * edge_radius_px;
    const float z_m = depth_at(depth_m, x_px, y_px);
    if (z_m > 0 && moves(x_px, y_px, z_m)) return Rule::edge;
  }
  return Rule::kept;
}

}  // namespace ydd
