// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/surfaces.h"

#include <array>
#include <cmath>

#include "ydd/evidence/seen_from.h"

namespace ydd {
Surfaces find_surfaces(const CoarseDepth& depth, std::span<const Eigen::Vector2f> rays,
                       const EvidenceOptions& options) {
  const CellGrid& grid = depth.grid;
  Surfaces out;
  out.piece.assign(depth.z_m.size(), -1);
  const auto reach2_m2 = static_cast<float>(options.patch_radius_m * options.patch_radius_m);
  const auto step_share = static_cast<float>(options.step_share);
  std::vector<int> waiting;
  waiting.reserve(static_cast<std::size_t>(grid.cells()));
  for (int first = 0; first < grid.cells(); ++first) {
    const auto start = static_cast<std::size_t>(first);
    if (depth.z_m[start] <= 0 || out.piece[start] >= 0) continue;
    const Eigen::Vector3f centre = point_on(rays[start], depth.z_m[start]);
    out.piece[start] = out.count;
    waiting.assign(1, first);
    while (!waiting.empty()) {
      const int cell = waiting.back();
      waiting.pop_back();
      const float z_m = depth.z_m[static_cast<std::size_t>(cell)];
      const int column = cell % grid.columns;
      const int row = cell / grid.columns;
      constexpr std::array<std::array<int, 2>, 4> kSides = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
      for (const auto& [dc, dr] : kSides) {
        if (!grid.contains(column + dc, row + dr)) continue;
        const int next = grid.index(column + dc, row + dr);
        const auto n = static_cast<std::size_t>(next);
        if (depth.z_m[n] <= 0 || out.piece[n] >= 0) continue;
        if (std::abs(depth.z_m[n] - z_m) > step_share * z_m) continue;
        if ((point_on(rays[n], depth.z_m[n]) - centre).squaredNorm() > reach2_m2) continue;
        out.piece[n] = out.count;
        waiting.push_back(next);
      }
    }
    ++out.count;
  }
  return out;
}

}  // namespace ydd
