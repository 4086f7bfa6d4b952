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

namespace {

/// Tells what of the map does not fit the run; what fits nearly is logged.
Result<void> check_map(const RunRequest& request, const Camera& map_camera,
                       const PyramidScales& map_scales, const Camera& camera,
                       const SystemOptions& options) {
  auto same = check_same_camera(map_camera, camera);
  if (same) {
    same = check_same_scales(map_scales,
                             PyramidScales::make(options.orb.levels, options.orb.scale_step));
  }
  if (!same) return Error{fmt::format("{}: {}", request.map, same.error().message)};
  if (const double px = camera_difference_px(map_camera, camera); px > 0.01) {
    log::info(
        "{}: its camera differs from this one by up to {:.2f} px (at most {:.1f} may); "
        "the map's calibration is used",
        request.map, px, kCameraTolerance * camera.width_px);
  }
  return {};
}

/// The map if only a part of it is wanted in memory; else nothing.
Result<std::optional<StoredMap>> open_in_part(const RunRequest& request, const MapKey& key,
                                              const SystemOptions& options) {
  const bool wanted = request.localization_only && request.save_map.empty() && !request.dump_map &&
                      options.map.near_keyframes > 0;
  if (!wanted) return std::optional<StoredMap>();
  Result<StoredMap> stored = StoredMap::open(request.map, key);
  if (!stored) return stored.error();
  if (stored->keyframes() <= static_cast<std::size_t>(options.map.near_keyframes)) {
    return std::optional<StoredMap>();
  }
  if (!stored->has_parts()) {
    log::warning(
        "{}: was saved by an earlier ydd-slam and is loaded whole; `ydd-slam map merge` "
        "writes one that need not be",
        request.map);
    return std::optional<StoredMap>();
  }
  return std::optional<StoredMap>(std::move(*stored));
}

Result<RunMap> open_nearby(StoredMap stored, const SystemOptions& options) {
  NearbyOptions nearby;
  nearby.keyframes = static_cast<std::size_t>(options.map.near_keyframes);
  nearby.places = static_cast<std::size_t>(options.tracking.place_candidates);
  nearby.in_background = !options.deterministic;
  log::info("{}: {} keyframes; what is near the camera is loaded", stored.file().string(),
            stored.keyframes());
  auto map = NearbyMap::open(std::move(stored), nearby);
  if (!map) return map.error();
  return RunMap{std::nullopt, std::move(*map)};
}

}  // namespace

Result<RunMap> open_run_map(const RunRequest& request, const MapKey& key, const Camera& camera,
                            const SystemOptions& options) {
  if (request.map.empty()) return RunMap();
  Result<std::optional<StoredMap>> stored = open_in_part(request, key, options);
  if (!stored) return stored.error();
  if (*stored) {
    auto fits = check_map(request, (*stored)->camera(), (*stored)->scales(), camera, options);
    if (!fits) return fits.error();
    return open_nearby(*std::move(*stored), options);
  }
  Result<Atlas> atlas = load_map(request.map, key);
  if (!atlas) return atlas.error();
  auto fits = check_map(request, atlas->camera(), atlas->scales(), camera, options);
  if (!fits) return fits.error();
  if (atlas->keyframes().empty()) {
    if (request.localization_only) return Error{fmt::format("{}: holds no keyframe", request.map)};
    log::warning("{}: holds no keyframe; the run starts from nothing", request.map);
  }
  return RunMap{std::move(*atlas), nullptr};
}

SlamSystem make_run_system(const Camera& camera, const SystemOptions& options,
                           const ObjectCatalogue& catalogue, std::unique_ptr<Detector> detector,
                           RunMap map) {
  if (map.nearby) {
    return {camera, options, catalogue, std::move(detector), std::move(map.nearby)};
  }
  return {camera, options, catalogue, std::move(detector), std::move(map.whole)};
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
