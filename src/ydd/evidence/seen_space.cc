// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/seen_space.h"

#include <cmath>

#include "ydd/evidence/seen_from.h"

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

std::vector<Space> space_then(const CoarseDepth& now, const CoarseDepth& then,
                              const SE3& T_then_now, const Camera& camera,
                              std::span<const Eigen::Vector2f> rays,
                              const EvidenceOptions& options) {
  std::vector<Space> out(now.z_m.size(), Space::unknown);
  const SeenFrom there(T_then_now, camera);
  SeenFrom::Place place;
  const auto sigmas = static_cast<float>(options.sigmas);
  const auto slack_m = static_cast<float>(options.slack_m);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float z_m = now.z_m[i];
    if (z_m <= 0 || !there.see(point_on(rays[i], z_m), place)) continue;
    if (!(place.x_px >= 0 && place.y_px >= 0)) continue;
    const int column = then.grid.cell_of(place.x_px);
    const int row = then.grid.cell_of(place.y_px);
    if (!then.grid.contains(column, row)) continue;
    const float sigma_m = options.noise.sigma_m(z_m);
    const float tolerance_m = slack_m + 1.42F * sigmas * sigma_m;
    out[i] =
        judge(place.z_m, tolerance_m, then, static_cast<std::size_t>(then.grid.index(column, row)));
  }
  return out;
}

}  // namespace ydd
