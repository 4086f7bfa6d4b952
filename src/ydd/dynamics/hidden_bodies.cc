// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/hidden_bodies.h"

#include <algorithm>
#include <vector>

#include "ydd/dynamics/object_depth.h"

namespace ydd {
namespace {

/// Steps of the grid each way, and the share of the readings that is passed over as outliers.
constexpr int kSteps = 24;
constexpr double kNearestShare = 0.1;

bool explained(const PointSample& point, std::size_t own, std::span<const MovingRegion> regions) {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (i != own && regions[i].range && in_region(regions[i], point)) return true;
  }
  return false;
}

}  // namespace

std::optional<float> unexplained_depth(const DepthImage& depth_m, std::size_t index,
                                       std::span<const MovingRegion> regions, double least_share) {
  const Box& box = regions[index].box;
  std::vector<float> rest;
  int readings = 0;
  for (int row = 1; row < kSteps; ++row) {
    for (int column = 1; column < kSteps; ++column) {
      PointSample point;
      point.x_px = box.x0 + box.width() * static_cast<float>(column) / kSteps;
      point.y_px = box.y0 + box.height() * static_cast<float>(row) / kSteps;
      point.depth_m = depth_at(depth_m, point.x_px, point.y_px);
      if (point.depth_m <= 0.0F) continue;
      ++readings;
      if (!explained(point, index, regions)) rest.push_back(point.depth_m);
    }
  }
  if (rest.empty() || static_cast<double>(rest.size()) < least_share * readings) {
    return std::nullopt;
  }
  const auto nearest =
      rest.begin() + static_cast<std::ptrdiff_t>(kNearestShare * static_cast<double>(rest.size()));
  std::nth_element(rest.begin(), nearest, rest.end());
  return *nearest;
}

}  // namespace ydd
