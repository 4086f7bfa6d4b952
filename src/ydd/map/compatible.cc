// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/compatible.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include <fmt/format.h>

namespace ydd {

double camera_difference_px(const Camera& a, const Camera& b) {
  constexpr int kSteps = 16;
  double largest_px = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d pixel(static_cast<double>(i) * a.width_px / kSteps,
                                  static_cast<double>(j) * a.height_px / kSteps);
      const Eigen::Vector3d ray = a.unproject(a.undistort(pixel), 1.0);
      const double moved_px = (b.distort(b.project(ray)) - pixel).norm();
      // Not a number where a lens model folds over: no difference that could be told.
      if (!std::isfinite(moved_px)) return HUGE_VAL;
      largest_px = std::max(largest_px, moved_px);
    }
  }
  return largest_px;
}

Result<void> check_same_camera(const Camera& of_map, const Camera& camera) {
  const auto another = [](const std::string& how) {
    return Error{
        fmt::format("made with another camera: {}; give the map's camera with --camera", how)};
  };
  for (const auto& [name, a, b] : {std::tuple{"width", of_map.width_px, camera.width_px},
                                   std::tuple{"height", of_map.height_px, camera.height_px}}) {
    if (a != b) return another(fmt::format("{} is {} in the map and {} now", name, a, b));
  }
  const double difference_px = camera_difference_px(of_map, camera);
  const double allowed_px = kCameraTolerance * of_map.width_px;
  if (!(difference_px <= allowed_px)) {
    return another(
        fmt::format("fx is {} in the map and {} now, fy {} and {}, cx {} and {}, cy {} and {}; "
                    "pixels differ by "
                    "up to {:.1f} px, at most {:.1f} px may",
                    of_map.fx_px, camera.fx_px, of_map.fy_px, camera.fy_px, of_map.cx_px,
                    camera.cx_px, of_map.cy_px, camera.cy_px, difference_px, allowed_px));
  }
  constexpr double kBaselineTolerance = 0.01;
  if (std::abs(of_map.baseline_m - camera.baseline_m) > kBaselineTolerance * of_map.baseline_m) {
    return another(
        fmt::format("baseline is {} in the map and {} now", of_map.baseline_m, camera.baseline_m));
  }
  return {};
}

Result<void> check_same_scales(const PyramidScales& of_map, const PyramidScales& scales) {
  if (of_map.factor == scales.factor) return {};
  const auto step = [](const PyramidScales& s) { return s.levels() > 1 ? s.factor[1] : 1.0; };
  return Error{
      fmt::format("made with orb.levels={} and orb.scale_step={}, not {} and {}; set those",
                  of_map.levels(), step(of_map), scales.levels(), step(scales))};
}

}  // namespace ydd
