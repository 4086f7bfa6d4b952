// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/keep_maps.h"

#include <algorithm>
#include <map>
#include <utility>

namespace ydd {
namespace {

void take_keyframes(const Atlas& atlas, const std::set<MapId>& maps, AtlasParts& parts) {
  std::int64_t newest = -1;
  parts.freed_keyframes = atlas.keyframes().freed();
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (!maps.contains(keyframe.map)) {
      parts.freed_keyframes.push_back(id);
      return;
    }
    KeyFrame kept = keyframe;
    std::erase_if(kept.loops, [&](KeyFrameId loop) { return !maps.contains(atlas.map_of(loop)); });
    parts.keyframes.emplace_back(id, std::move(kept));
    if (keyframe.serial <= newest) return;
    newest = keyframe.serial;
    parts.newest = id;
  });
  atlas.culled().for_each([&](KeyFrameId id, const CulledKeyFrame& culled) {
    if (maps.contains(atlas.map_of(id))) parts.culled[id] = culled;
  });
}

void take_points(const Atlas& atlas, const std::set<MapId>& maps, AtlasParts& parts) {
  parts.freed_points = atlas.points().freed();
  atlas.points().for_each([&](MapPointId id, const MapPoint& point) {
    MapPoint kept = point;
    std::erase_if(kept.observations,
                  [&](const Observation& s) { return !maps.contains(atlas.at(s.keyframe).map); });
    if (kept.observations.empty()) {
      parts.freed_points.push_back(id);
    } else {
      parts.points.emplace_back(id, std::move(kept));
    }
  });
}

/// Maps that are worth keeping: the largest always, ties to the older.
std::set<MapId> large_maps(const Atlas& atlas, int min_keyframes) {
  std::map<MapId, int> sizes;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& k) { ++sizes[k.map]; });
  std::set<MapId> large;
  if (sizes.empty()) return large;
  large.insert(std::max_element(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) {
                 return a.second < b.second;
               })->first);
  for (const auto& [map, size] : sizes) {
    if (size >= min_keyframes) large.insert(map);
  }
  return large;
}

std::size_t count_maps(const Atlas& atlas) { return large_maps(atlas, 0).size(); }

}  // namespace

Result<Atlas> keep_maps(const Atlas& atlas, const std::set<MapId>& maps) {
  AtlasParts parts;
  parts.camera = atlas.camera();
  parts.scales = atlas.scales();
  take_keyframes(atlas, maps, parts);
  take_points(atlas, maps, parts);
  if (parts.keyframes.empty()) return Error{"holds no keyframe of these maps"};
  parts.revision = atlas.revision() + 1;
  parts.next_serial = atlas.next_serial();
  parts.maps = atlas.maps();
  return Atlas::restore(std::move(parts));
}

Result<PrunedMap> prune_atlas(const Atlas& atlas, const PruneOptions& options) {
  Result<Atlas> kept = keep_maps(atlas, large_maps(atlas, options.min_keyframes));
  if (!kept) return kept.error();
  for (const MapPointId id : kept->points().ids()) {
    const auto seen = static_cast<int>(kept->at(id).observations.size());
    if (seen < options.min_observations) kept->remove_point(id);
  }
  for (const KeyFrameId id : kept->keyframes().ids()) {
    const std::vector<MapPointId>& points = kept->at(id).points;
    const auto seen = std::count_if(points.begin(), points.end(),
                                    [](const MapPointId& point) { return point.valid(); });
    if (seen < options.min_points && !kept->is_first(id)) kept->cull_keyframe(id);
  }
  PrunedMap out{std::move(*kept), 0, 0, 0};
  out.maps = count_maps(atlas) - count_maps(out.atlas);
  out.keyframes = atlas.keyframes().size() - out.atlas.keyframes().size();
  out.points = atlas.points().size() - out.atlas.points().size();
  return out;
}

}  // namespace ydd
