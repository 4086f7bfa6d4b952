// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/motion_odds.h"

#include <cmath>
#include <limits>

#include "ydd/evidence/seen_from.h"

namespace ydd {
namespace {
constexpr float kNeverMoved_s = 0.3F;  // as calm as what has stood still for so long
}  // namespace

int MotionOdds::cell_at(float x_px, float y_px, float depth_m) const {
  const CellGrid& grid = depth.grid;
  if (x_px < 0 || y_px < 0) return -1;
  const int column = grid.cell_of(x_px);
  const int row = grid.cell_of(y_px);
  if (!grid.contains(column, row)) return -1;
  const int own = grid.index(column, row);
  if (depth_m <= 0) return own;
  int best = -1;
  float least_m = std::numeric_limits<float>::infinity();
  const float own_m = depth.z_m[static_cast<std::size_t>(own)];
  if (own_m > 0) {
    best = own;
    least_m = std::abs(own_m - depth_m);
    if (least_m < 0.03F * depth_m) return own;
  }
  for (int r = row - 1; r <= row + 1; ++r) {
    for (int c = column - 1; c <= column + 1; ++c) {
      if (!grid.contains(c, r)) continue;
      const float z_m = depth.z_m[static_cast<std::size_t>(grid.index(c, r))];
      const float off_m = std::abs(z_m - depth_m);
      if (z_m <= 0 || off_m >= least_m) continue;
      least_m = off_m;
      best = grid.index(c, r);
    }
  }
  return best;
}

bool MotionOdds::contradicts(float x_px, float y_px, float depth_m, float tolerance_m) const {
  const int own = cell_at(x_px, y_px, 0);
  if (own < 0) return false;
  if (depth.near_m[static_cast<std::size_t>(own)] > depth_m + tolerance_m) return true;
  const int cell = cell_at(x_px, y_px, depth_m);
  if (cell < 0) return false;
  const auto i = static_cast<std::size_t>(cell);
  return moves[i] != 0 && std::abs(depth.z_m[i] - depth_m) <= tolerance_m;
}

MotionOdds carried_odds(const MotionOdds& before, CoarseDepth depth, const SE3& T_before_now,
                        const Camera& camera, std::span<const Eigen::Vector2f> rays,
                        const EvidenceOptions& options) {
  MotionOdds out;
  out.depth = std::move(depth);
  out.log_odds.assign(out.depth.z_m.size(), 0.0F);
  out.moves.assign(out.depth.z_m.size(), 0);
  out.calm_s.assign(out.depth.z_m.size(), kNeverMoved_s);
  if (before.empty()) return out;
  if (!before.prior.empty()) out.prior.assign(out.depth.z_m.size(), 0.0F);
  const SeenFrom there(T_before_now, camera);
  SeenFrom::Place place;
  for (std::size_t i = 0; i < out.log_odds.size(); ++i) {
    const float z_m = out.depth.z_m[i];
    if (z_m <= 0 || !there.see(point_on(rays[i], z_m), place)) continue;
    const int cell = before.cell_at(place.x_px, place.y_px, place.z_m);
    if (cell < 0) continue;
    const auto b = static_cast<std::size_t>(cell);
    const float off_m = std::abs(before.depth.z_m[b] - place.z_m);
    // Generous: what moves comes nearer or goes away by centimetres from frame to frame.
    if (off_m > 0.06F + 3 * options.noise.sigma_m(z_m)) continue;
    out.log_odds[i] = before.log_odds[b];
    out.moves[i] = before.moves[b];
    out.calm_s[i] = before.calm_s[b];
    if (!before.prior.empty()) out.prior[i] = before.prior[b];
  }
  return out;
}

}  // namespace ydd
