// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/seen_space.h"

#include <cmath>

namespace ydd {
namespace {

Space judge(float z_m, float tolerance_m, const CoarseDepth& then, std::size_t cell) {
  const float near_m = then.near_m[cell];
  if (near_m <= 0) return Space::unknown;
  if (z_m < near_m - tolerance_m) return Space::empty;
  if (z_m > then.far_m[cell] + tolerance_m) return Space::hidden;
  const float there_m = then.z_m[cell];
  if (there_m <= 0) return Space::unknown;
  return std::abs(z_m - there_m) <= tolerance_m ? Space::same : Space::unknown;
}

}  // namespace

void space_then(const PointList& now, const CoarseDepth& then, const SE3& T_then_now,
                const Camera& camera, const EvidenceOptions& options, SeenFrom::Places& places,
                std::vector<Space>& out) {
  SeenFrom(T_then_now, camera).see_all(now, places);
  out.assign(now.size(), Space::unknown);
  const CellGrid grid = then.grid;
  const SensorNoise noise = options.noise;
  const float sigmas = 1.42F * static_cast<float>(options.sigmas);
  const auto slack_m = static_cast<float>(options.slack_m);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool seen = now.z_m[i] > 0 && places.z_m[i] > 0;
    if (!seen || !(places.x_px[i] >= 0 && places.y_px[i] >= 0)) continue;
    const int column = grid.cell_of(places.x_px[i]);
    const int row = grid.cell_of(places.y_px[i]);
    if (!grid.contains(column, row)) continue;
    const float tolerance_m = slack_m + sigmas * noise.sigma_m(now.z_m[i]);
    out[i] =
        judge(places.z_m[i], tolerance_m, then, static_cast<std::size_t>(grid.index(column, row)));
  }
}

}  // namespace ydd
