// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ydd/dynamics/point_rules.h"
#include "ydd/evidence/motion_odds.h"

/// What variant `evidence` makes of the odds that surfaces move (docs/method.md, section 11).
namespace ydd {

/// What is presumed of a region before anything is seen of it: log-odds that it moves.
float prior_log_odds(Rule rule);

/// The same for the cells that regions cover; 0: no region does.
std::vector<float> prior_of_cells(std::span<const MovingRegion> regions, const MotionOdds& odds);

/// What the evidence says of a region: means over the cells in it.
struct RegionOdds {
  float log_odds = 0;      ///< without what is presumed
  float moving_share = 0;  ///< of the cells that are judged to move
  float calm_s = 0;        ///< without a sign of motion
  int cells = 0;           ///< with a reading in the region
};
RegionOdds region_odds(const MovingRegion& region, const MotionOdds& odds);

/// Whether at least half of the region is judged to move, whatever it is called.
bool is_seen_to_move(const RegionOdds& found);

/// Whether the region stands still, whatever it is called: the evidence outweighs what is presumed,
/// no larger part of it moves, and that for a while. Without a reading what is presumed stays.
bool stands_still(const RegionOdds& found, Rule rule);

/// Whether a point that a region would reject lies on a surface that has stood still for long.
bool stands_still(const PointSample& point, const MotionOdds& odds);

/// The rule of a point by the evidence alone: on a surface that moves, or within `edge_radius_px`
/// of one, else kept.
Rule evidence_rule(const PointSample& point, const MotionOdds& odds, const DepthImage& depth_m,
                   float edge_radius_px);

}  // namespace ydd
