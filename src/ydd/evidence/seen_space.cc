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

std::vector<Space> space_then(const CoarseDepth& now, const CoarseDepth& then,
                              const SE3& T_then_now, const Camera& camera,
                              std::span<const Eigen::Vector2f> rays,
                              const EvidenceOptions& options) {
  std::vector<Space> out(now.z_m.size(), Space::unknown);
  const Eigen::Matrix3f rotation = T_then_now.rotation_matrix().cast<float>();
  const Eigen::Vector3f shift_m = T_then_now.translation().cast<float>();
  const auto fx = static_cast<float>(camera.fx_px), fy = static_cast<float>(camera.fy_px);
  const auto cx = static_cast<float>(camera.cx_px), cy = static_cast<float>(camera.cy_px);
  const bool lens = camera.has_distortion();
  const auto sigmas = static_cast<float>(options.sigmas);
  const auto slack_m = static_cast<float>(options.slack_m);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float z_m = now.z_m[i];
    if (z_m <= 0) continue;
    const Eigen::Vector3f p =
        rotation * Eigen::Vector3f(rays[i].x() * z_m, rays[i].y() * z_m, z_m) + shift_m;
    if (p.z() <= 0.05F) continue;
    float u_px = fx * p.x() / p.z() + cx;
    float v_px = fy * p.y() / p.z() + cy;
    if (lens) {
      const Eigen::Vector2d px = camera.distort({u_px, v_px});
      u_px = static_cast<float>(px.x());
      v_px = static_cast<float>(px.y());
    }
    if (!(u_px >= 0 && v_px >= 0)) continue;
    const int column = then.grid.cell_of(u_px);
    const int row = then.grid.cell_of(v_px);
    if (!then.grid.contains(column, row)) continue;
    const float sigma_m = options.noise.sigma_m(z_m);
    const float tolerance_m = slack_m + 1.42F * sigmas * sigma_m;
    out[i] =
        judge(p.z(), tolerance_m, then, static_cast<std::size_t>(then.grid.index(column, row)));
  }
  return out;
}

}  // namespace ydd
