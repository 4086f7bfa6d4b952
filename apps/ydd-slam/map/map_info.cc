// SPDX-License-Identifier: Apache-2.0
#include "map/map_info.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "map/map_jobs.h"
#include "ydd/base/json_text.h"
#include "ydd/map_files/map_file.h"

namespace ydd::app {
namespace {

using Json = nlohmann::ordered_json;

MapInfo describe_map(const Atlas& atlas, MapId map, std::vector<const KeyFrame*> keyframes) {
  std::sort(keyframes.begin(), keyframes.end(),
            [](const KeyFrame* a, const KeyFrame* b) { return a->serial < b->serial; });
  MapInfo info;
  info.map = map;
  info.keyframes = keyframes.size();
  const Eigen::Vector3d* before = nullptr;
  info.first = info.last = keyframes.front()->stamp;
  info.low_m = info.high_m = keyframes.front()->T_world_camera.translation();
  for (const KeyFrame* const k : keyframes) {
    const Eigen::Vector3d& at = k->T_world_camera.translation();
    if (before) info.path_m += (at - *before).norm();
    before = &at;
    info.first = std::min(info.first, k->stamp);
    info.last = std::max(info.last, k->stamp);
    info.low_m = info.low_m.cwiseMin(at);
    info.high_m = info.high_m.cwiseMax(at);
    info.pictures += k->picture ? 1 : 0;
    info.loops += k->loops.size();
  }
  info.loops /= 2;  // told by both ends
  atlas.points().for_each([&](MapPointId, const MapPoint& point) {
    if (atlas.map_of(point.observations.front().keyframe) == map) ++info.points;
  });
  return info;
}

Json json_of(const MapInfo& m) {
  const Eigen::Vector3d size_m = m.high_m - m.low_m;
  return {{"number", m.map.slot},
          {"keyframes", m.keyframes},
          {"points", m.points},
          {"loops", m.loops},
          {"pictures", m.pictures},
          {"first_stamp_s", m.first.seconds()},
          {"last_stamp_s", m.last.seconds()},
          {"path_m", m.path_m},
          {"extent_m", {size_m.x(), size_m.y(), size_m.z()}}};
}

Json json_of(const Atlas& atlas, const std::string& file, const std::vector<MapInfo>& maps) {
  const Camera& c = atlas.camera();
  Json list = Json::array();
  for (const MapInfo& m : maps) list.push_back(json_of(m));
  return {{"file", file},
          {"bytes", std::filesystem::file_size(file)},
          {"keyframes", atlas.keyframes().size()},
          {"points", atlas.points().size()},
          {"culled_keyframes", atlas.culled().size()},
          {"camera",
           {{"name", c.name},
            {"width", c.width_px},
            {"height", c.height_px},
            {"fx", c.fx_px},
            {"fy", c.fy_px},
            {"cx", c.cx_px},
            {"cy", c.cy_px}}},
          {"pyramid_levels", atlas.scales().levels()},
          {"maps", list}};
}

std::string text_of(const Atlas& atlas, const std::string& file, const std::vector<MapInfo>& maps) {
  const Camera& c = atlas.camera();
  std::string out = fmt::format(
      "{}: {:.1f} MB, {} keyframes, {} points, {} {}\n"
      "camera {}: {}x{}, fx {:g} fy {:g} cx {:g} cy {:g}\n",
      file, static_cast<double>(std::filesystem::file_size(file)) * 1e-6, atlas.keyframes().size(),
      atlas.points().size(), maps.size(), maps.size() == 1 ? "map" : "maps", c.name, c.width_px,
      c.height_px, c.fx_px, c.fy_px, c.cx_px, c.cy_px);
  for (const MapInfo& m : maps) {
    const Eigen::Vector3d size_m = m.high_m - m.low_m;
    out += fmt::format(
        "map {}: {} keyframes ({} with picture), {} points, {} loops, {:.2f} m along its "
        "keyframes, {:.2f} x {:.2f} x {:.2f} m, stamps {:.3f} to {:.3f} s\n",
        m.map.slot, m.keyframes, m.pictures, m.points, m.loops, m.path_m, size_m.x(), size_m.y(),
        size_m.z(), m.first.seconds(), m.last.seconds());
  }
  return out;
}

}  // namespace

std::vector<MapInfo> describe_maps(const Atlas& atlas) {
  std::map<MapId, std::vector<const KeyFrame*>> keyframes;
  atlas.keyframes().for_each(
      [&](KeyFrameId, const KeyFrame& k) { keyframes[k.map].push_back(&k); });
  std::vector<MapInfo> out;
  out.reserve(keyframes.size());
  for (auto& [map, list] : keyframes) out.push_back(describe_map(atlas, map, std::move(list)));
  std::stable_sort(out.begin(), out.end(),
                   [](const MapInfo& a, const MapInfo& b) { return a.keyframes > b.keyframes; });
  return out;
}

Result<void> map_info(const MapInfoRequest& request) {
  const Result<MapKey> key = MapKey::find(request.map_key);
  if (!key) return key.error();
  const Result<Atlas> atlas = load_map(request.file, *key);
  if (!atlas) return atlas.error();
  const std::vector<MapInfo> maps = describe_maps(*atlas);
  if (request.json) {
    fmt::print("{}\n", json_text(json_of(*atlas, request.file, maps), 2));
  } else {
    fmt::print("{}", text_of(*atlas, request.file, maps));
  }
  return {};
}

}  // namespace ydd::app
