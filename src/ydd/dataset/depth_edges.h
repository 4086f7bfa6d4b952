// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdlib>

namespace ydd {

/// Whether two readings (counts, 0: none) that lie side by side belong to two things: a step of
/// depth that is no slope. It grows with distance as the sensor's noise does.
inline bool is_depth_edge(int a, int b) {
  constexpr double kStep = 0.06;
  return a > 0 && b > 0 && std::abs(a - b) > kStep * std::min(a, b);
}

/// Pixels between the two readings of an edge: across the seam between the surfaces.
constexpr int kDepthEdgeReach_px = 2;

}  // namespace ydd
