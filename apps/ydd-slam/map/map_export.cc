// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "map/map_info.h"
#include "map/map_jobs.h"
#include "ydd/base/files.h"
#include "ydd/base/log.h"
#include "ydd/cloud/keyframe_picture.h"
#include "ydd/cloud/ply.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/map_files/map_file.h"

namespace ydd::app {
namespace {

/// The map that is asked for, or the largest.
Result<MapInfo> choose(const Atlas& atlas, const MapExportRequest& request) {
  const std::vector<MapInfo> maps = describe_maps(atlas);
  if (maps.empty()) return Error{fmt::format("{}: holds no keyframe", request.file)};
  if (request.which < 0) {
    if (maps.size() > 1) {
      log::warning("{}: holds {} maps; number {}, the largest, is taken (--which chooses)",
                   request.file, maps.size(), maps.front().map.slot);
    }
    return maps.front();
  }
  for (const MapInfo& map : maps) {
    if (map.map.slot == static_cast<std::uint32_t>(request.which)) return map;
  }
  return Error{fmt::format("{}: holds no map number {}; 'ydd-slam map info' lists them",
                           request.file, request.which)};
}

Result<void> export_keyframes(const Atlas& atlas, MapId map, const std::string& file) {
  StampedPoses poses;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    if (keyframe.map == map) poses.push_back({keyframe.stamp, keyframe.T_world_camera});
  });
  std::stable_sort(poses.begin(), poses.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.stamp < b.stamp; });
  return write_file_atomically(file, format_trajectory(poses, TrajectoryFormat::tum));
}

/// How much colour a redacted cloud has.
void tell_redaction(const Atlas& atlas, const MapInfo& map, const std::string& file) {
  std::size_t left_out = 0;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    const bool counts = keyframe.map == map.map && keyframe.picture;
    left_out += counts && people_left_out(*keyframe.picture) ? 1 : 0;
  });
  if (left_out == map.pictures) return;
  log::warning(
      "{}: of {} of its {} pictures it is not known whether people are left out; they give no "
      "colour",
      file, map.pictures - left_out, map.pictures);
}

Result<void> export_dense(const Atlas& atlas, MapId map, const MapExportRequest& request) {
  const Result<std::vector<CloudPoint>> cloud = dense_cloud(atlas, map, request.cloud);
  if (!cloud) return Error{fmt::format("{}: {}", request.file, cloud.error().message)};
  return write_file_atomically(request.dense, format_ply(*cloud));
}

/// The picture first: a YAML without it would be half of a map.
Result<void> export_grid(const Atlas& atlas, MapId map, const MapExportRequest& request) {
  GridOptions options = request.grid_options;
  options.cloud = request.cloud;
  const Result<FloorPlane> floor = floor_of_map(atlas, map, options.cloud);
  if (!floor) return Error{fmt::format("{}: {}", request.file, floor.error().message)};
  if (!floor->found) {
    log::warning("{}: no floor was seen; the lowest points are taken for it", request.file);
  }
  const Result<OccupancyGrid> grid = occupancy_grid(atlas, map, level_frame(*floor), options);
  if (!grid) return Error{fmt::format("{}: {}", request.file, grid.error().message)};
  if (grid->empty()) return Error{fmt::format("{}: its pictures show nothing near", request.file)};
  if (auto r = write_file_atomically(request.grid, format_pgm(*grid)); !r) return r;
  const std::filesystem::path picture = request.grid;
  std::filesystem::path yaml = picture;
  yaml.replace_extension(".yaml");
  return write_file_atomically(yaml, format_map_yaml(*grid, picture.filename().string()));
}

}  // namespace

Result<void> map_export(const MapExportRequest& request) {
  const Result<MapKey> key = MapKey::find(request.map_key);
  if (!key) return key.error();
  const Result<Atlas> atlas = load_map(request.file, *key);
  if (!atlas) return atlas.error();
  const Result<MapInfo> chosen = choose(*atlas, request);
  if (!chosen) return chosen.error();
  const bool needs_pictures =
      !request.dense.empty() || !request.octomap.empty() || !request.grid.empty();
  if (needs_pictures && chosen->pictures == 0) {
    return Error{fmt::format("{}: its keyframes keep no pictures; record with map.pictures=true",
                             request.file)};
  }
  const auto write = [&](const std::string& file, auto&& make) -> Result<void> {
    if (file.empty()) return {};
    if (auto r = make(); !r) return r;
    fmt::print("wrote {}\n", file);
    return {};
  };
  auto done = write(request.sparse, [&] {
    return write_file_atomically(request.sparse, format_sparse_ply(*atlas, chosen->map));
  });
  if (done) {
    done = write(request.keyframes,
                 [&] { return export_keyframes(*atlas, chosen->map, request.keyframes); });
  }
  if (done) {
    if (request.cloud.redact) tell_redaction(*atlas, *chosen, request.file);
    done = write(request.dense, [&] { return export_dense(*atlas, chosen->map, request); });
  }
  if (done) {
    done = write(request.octomap, [&] { return export_octomap(*atlas, chosen->map, request); });
  }
  if (done) done = write(request.grid, [&] { return export_grid(*atlas, chosen->map, request); });
  return done;
}

}  // namespace ydd::app
