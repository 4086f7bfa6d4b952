// SPDX-License-Identifier: Apache-2.0
#include "run/run_map.h"

#include <fmt/format.h>

#include "ydd/base/log.h"
#include "ydd/map/compatible.h"
#include "ydd/map_files/map_file.h"

namespace ydd::app {

Result<MapKey> run_map_key(const RunRequest& request) {
  // Who watches can save a map that the request does not name.
  const bool watched = request.view.window || request.serve;
  const bool wanted = watched || !request.map.empty() || !request.save_map.empty();
  return wanted ? MapKey::find(request.map_key) : Result(MapKey());
}

Result<std::optional<Atlas>> open_run_map(const RunRequest& request, const MapKey& key,
                                          const Camera& camera, const SystemOptions& options) {
  if (request.map.empty()) return std::optional<Atlas>();
  Result<Atlas> atlas = load_map(request.map, key);
  if (!atlas) return atlas.error();
  auto same = check_same_camera(atlas->camera(), camera);
  if (same) {
    same = check_same_scales(atlas->scales(),
                             PyramidScales::make(options.orb.levels, options.orb.scale_step));
  }
  if (!same) return Error{fmt::format("{}: {}", request.map, same.error().message)};
  if (const double px = camera_difference_px(atlas->camera(), camera); px > 0.01) {
    log::info(
        "{}: its camera differs from this one by up to {:.2f} px (at most {:.1f} may); "
        "the map's calibration is used",
        request.map, px, kCameraTolerance * camera.width_px);
  }
  if (atlas->keyframes().empty()) {
    if (request.localization_only) return Error{fmt::format("{}: holds no keyframe", request.map)};
    log::warning("{}: holds no keyframe; the run starts from nothing", request.map);
  }
  return std::optional<Atlas>(std::move(*atlas));
}

Result<void> prepare_run_map(const RunRequest& request, const MapKey& key, SlamSystem& system) {
  system.set_map_key(key);
  system.set_localization_only(request.localization_only);
  return request.save_map.empty()
             ? Result<void>()
             : system.autosave_to(request.save_map,
                                  request.replace_map ? Replacing::anything : Replacing::lesser);
}

Result<void> save_run_map(const RunRequest& request, SlamSystem& system) {
  return request.save_map.empty() ? Result<void>() : system.save_map(request.save_map);
}

}  // namespace ydd::app
