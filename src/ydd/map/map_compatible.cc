// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "ydd/map/map_file.h"

namespace ydd {

Result<void> check_same_camera(const Camera& of_map, const Camera& camera) {
  const struct {
    const char* name;
    double a, b;
  } values[] = {
      {"width", static_cast<double>(of_map.width_px), static_cast<double>(camera.width_px)},
      {"height", static_cast<double>(of_map.height_px), static_cast<double>(camera.height_px)},
      {"fx", of_map.fx_px, camera.fx_px},
      {"fy", of_map.fy_px, camera.fy_px},
      {"cx", of_map.cx_px, camera.cx_px},
      {"cy", of_map.cy_px, camera.cy_px},
      {"k1", of_map.k1, camera.k1},
      {"k2", of_map.k2, camera.k2},
      {"p1", of_map.p1, camera.p1},
      {"p2", of_map.p2, camera.p2},
      {"k3", of_map.k3, camera.k3},
      {"baseline", of_map.baseline_m, camera.baseline_m}};
  for (const auto& value : values) {
    if (value.a != value.b) {
      return Error{
          fmt::format("made with another camera: {} is {} in the map and {} now; give the "
                      "map's camera with --camera",
                      value.name, value.a, value.b)};
    }
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
