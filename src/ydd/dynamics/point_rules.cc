// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/point_rules.h"

#include "ydd/dynamics/object_depth.h"

namespace ydd {

bool in_region(const MovingRegion& region, const PointSample& point) {
  return region.box.contains(point.x_px, point.y_px) &&
         (!region.range || region.range->contains(point.depth_m));
}

bool at_edge(const MovingRegion& region, const PointSample& point, const DepthImage& depth_m,
             float radius_px) {
  if (!region.range || !grown(region.box, radius_px).contains(point.x_px, point.y_px)) return false;
  const auto moving = [&](float dx, float dy) {
    return region.range->contains(depth_at(depth_m, point.x_px + dx, point.y_px + dy));
  };
  return moving(-radius_px, 0) || moving(radius_px, 0) || moving(0, -radius_px) ||
         moving(0, radius_px);
}

Rule rule_of(const PointSample& point, std::span<const MovingRegion> regions,
             const DepthImage& depth_m, float edge_radius_px) {
  for (const MovingRegion& region : regions) {
    if (in_region(region, point)) return region.rule;
  }
  if (edge_radius_px <= 0.0F) return Rule::kept;
  for (const MovingRegion& region : regions) {
    if (at_edge(region, point, depth_m, edge_radius_px)) return Rule::edge;
  }
  return Rule::kept;
}

}  // namespace ydd
