// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/point_rules.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ydd/dynamics/object_depth.h"

namespace ydd {
namespace {

struct Direction {
  int dx, dy;
};
constexpr int kAxes = 4;
constexpr std::array<Direction, 2 * kAxes> kDirections = {
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

/// The first reading from a point outward; 0: none within reach.
float next_reading(const DepthImage& depth_m, const PointSample& point, const Direction& towards,
                   int reach_px) {
  for (int step = 1; step <= reach_px; ++step) {
    const float d = depth_at(depth_m, point.x_px + static_cast<float>(towards.dx * step),
                             point.y_px + static_cast<float>(towards.dy * step));
    if (d > 0.0F) return d;
  }
  return 0.0F;
}

bool in_any_box(std::span<const MovingRegion> regions, const PointSample& point) {
  return std::any_of(regions.begin(), regions.end(), [&](const MovingRegion& region) {
    return region.box.contains(point.x_px, point.y_px);
  });
}

}  // namespace

bool MovingRegion::on_mask(float x_px, float y_px) const {
  const auto x = static_cast<int>(std::floor(x_px + 0.5F));
  const auto y = static_cast<int>(std::floor(y_px + 0.5F));
  return mask.contains(x, y) && mask(x, y) != 0;
}

bool in_region(const MovingRegion& region, const PointSample& point) {
  if (!region.box.contains(point.x_px, point.y_px)) return false;
  if (!region.mask.empty()) return region.on_mask(point.x_px, point.y_px);
  return !region.range || region.range->contains(point.depth_m);
}

bool at_edge(const MovingRegion& region, const PointSample& point, const DepthImage& depth_m,
             float radius_px) {
  const bool masked = !region.mask.empty();
  if (!masked && !region.range) return false;
  if (!grown(region.box, radius_px).contains(point.x_px, point.y_px)) return false;
  const auto moving = [&](float dx, float dy) {
    if (masked) return region.on_mask(point.x_px + dx, point.y_px + dy);
    return region.range->contains(depth_at(depth_m, point.x_px + dx, point.y_px + dy));
  };
  return moving(-radius_px, 0) || moving(radius_px, 0) || moving(0, -radius_px) ||
         moving(0, radius_px);
}

Surroundings surroundings_of(const PointSample& point, const DepthImage& depth_m, int reach_px) {
  Surroundings result{};
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = next_reading(depth_m, point, kDirections[i], reach_px);
  }
  return result;
}

bool surrounded_by(const MovingRegion& region, const PointSample& point,
                   const Surroundings& surroundings, int axes) {
  if (!region.range || !region.mask.empty() || point.depth_m > 0.0F ||
      !region.box.contains(point.x_px, point.y_px)) {
    return false;
  }
  int enclosing = 0;
  for (std::size_t i = 0; i < kAxes; ++i) {
    const bool both =
        region.range->contains(surroundings[i]) && region.range->contains(surroundings[i + kAxes]);
    enclosing += both ? 1 : 0;
  }
  return enclosing >= axes;
}

Rule rule_of(const PointSample& point, std::span<const MovingRegion> regions,
             const DepthImage& depth_m, const PointRuleOptions& options) {
  for (const MovingRegion& region : regions) {
    if (in_region(region, point)) return region.rule;
  }
  const float radius_px =
      point.depth_m > 0.0F ? options.edge_radius_px : options.unmeasured_edge_px;
  if (radius_px > 0.0F) {
    for (const MovingRegion& region : regions) {
      if (at_edge(region, point, depth_m, radius_px)) return Rule::edge;
    }
  }
  if (options.surround_px > 0 && point.depth_m <= 0.0F && in_any_box(regions, point)) {
    const Surroundings around = surroundings_of(point, depth_m, options.surround_px);
    for (const MovingRegion& region : regions) {
      if (surrounded_by(region, point, around, options.surround_axes)) return Rule::surrounded;
    }
  }
  return Rule::kept;
}

}  // namespace ydd
