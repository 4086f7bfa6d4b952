// SPDX-License-Identifier: Apache-2.0
// An atlas from stored parts. Nothing is believed: what does not fit together is a failure with a
// reason, and nothing is repaired.
#include <utility>

#include <fmt/format.h>

#include "ydd/map/atlas.h"

namespace ydd {
namespace {

bool features_agree(const Features& f, const PyramidScales& scales) {
  const std::size_t n = f.size();
  if (f.descriptors.size() != n || f.undistorted_px.size() != n || f.depth_m.size() != n ||
      f.right_px.size() != n) {
    return false;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Keypoint& k = f.keypoints[i];
    const bool finite = std::isfinite(k.x_px) && std::isfinite(k.y_px) &&
                        std::isfinite(k.angle_rad) && f.undistorted_px[i].allFinite() &&
                        std::isfinite(f.depth_m[i]) && std::isfinite(f.right_px[i]);
    if (!finite || k.octave < 0 || k.octave >= scales.levels()) return false;
  }
  return true;
}

/// What `check_consistency` takes for granted.
std::string fault_of_keyframes(const Atlas& atlas) {
  std::string fault;
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (!keyframe.shared_features || !features_agree(keyframe.features(), atlas.scales())) {
      fault = fmt::format("keyframe {}: keypoints that cannot be", id.slot);
    }
    if (!keyframe.map.valid() || keyframe.map.slot >= atlas.maps() || keyframe.serial < 0 ||
        keyframe.serial >= atlas.next_serial()) {
      fault = fmt::format("keyframe {}: of no map, or numbered wrongly", id.slot);
    }
  });
  return fault;
}

std::string fault_of_points(const Atlas& atlas) {
  std::string fault;
  atlas.points().for_each([&](MapPointId id, const MapPoint& point) {
    if (!point.p_world.allFinite() || !point.normal.allFinite() ||
        !std::isfinite(point.min_distance_m) || !std::isfinite(point.max_distance_m)) {
      fault = fmt::format("point {}: not a place in the world", id.slot);
    }
    for (const Observation& s : point.observations) {
      const KeyFrame* keyframe = atlas.find(s.keyframe);
      if (!keyframe || s.keypoint < 0 ||
          static_cast<std::size_t>(s.keypoint) >= keyframe->features().size()) {
        fault = fmt::format("point {}: seen by a keypoint that there is not", id.slot);
      }
    }
  });
  return fault;
}

/// Chains of culled keyframes must end in a kept one.
std::string fault_of_culled(const Atlas& atlas) {
  std::string fault;
  atlas.culled().for_each([&](KeyFrameId id, const CulledKeyFrame&) {
    KeyFrameId above = id;
    for (std::size_t steps = 0; fault.empty() && !atlas.find(above); ++steps) {
      const CulledKeyFrame* next = atlas.culled().find(above);
      if (!next || steps > atlas.culled().size()) {
        fault = fmt::format("culled keyframe {}: hangs on nothing", id.slot);
      } else {
        above = next->parent;
      }
    }
  });
  return fault;
}

std::string first_fault(const Atlas& atlas) {
  if (std::string fault = fault_of_keyframes(atlas); !fault.empty()) return fault;
  if (std::string fault = fault_of_points(atlas); !fault.empty()) return fault;
  if (std::string fault = fault_of_culled(atlas); !fault.empty()) return fault;
  if (atlas.newest_keyframe().valid() ? !atlas.find(atlas.newest_keyframe())
                                      : !atlas.keyframes().empty()) {
    return "its newest keyframe is none";
  }
  return {};
}

/// Gives each keyframe its list of children.
void link_children(Table<KeyFrame, KeyFrameTag>& keyframes) {
  for (const KeyFrameId id : keyframes.ids()) keyframes.edit(id).children.clear();
  for (const KeyFrameId id : keyframes.ids()) {
    const KeyFrameId parent = keyframes.at(id).parent;
    if (keyframes.contains(parent)) keyframes.edit(parent).children.push_back(id);
  }
}

/// Gives each keyframe its list of points. Failure: two points on one keypoint.
bool link_observations(Table<KeyFrame, KeyFrameTag>& keyframes,
                       const Table<MapPoint, MapPointTag>& points) {
  bool fits = true;
  for (const KeyFrameId id : keyframes.ids()) {
    KeyFrame& keyframe = keyframes.edit(id);
    keyframe.points.assign(keyframe.features().size(), MapPointId{});
  }
  points.for_each([&](MapPointId id, const MapPoint& point) {
    for (const Observation& s : point.observations) {
      MapPointId& link = keyframes.edit(s.keyframe).points[static_cast<std::size_t>(s.keypoint)];
      fits = fits && !link.valid();
      link = id;
    }
  });
  return fits;
}

/// Takes from points what keyframes saw that are not among these, and points that nobody else saw.
void keep_observations_by(const Table<KeyFrame, KeyFrameTag>& keyframes,
                          std::vector<std::pair<MapPointId, MapPoint>>& points) {
  std::erase_if(points, [&](auto& entry) {
    std::erase_if(entry.second.observations,
                  [&](const Observation& s) { return !keyframes.contains(s.keyframe); });
    return entry.second.observations.empty();
  });
}

WordIndex index_of(const Table<KeyFrame, KeyFrameTag>& keyframes) {
  std::vector<WordIndex::Entry> words;
  keyframes.for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (keyframe.words) words.push_back({keyframe.serial, id, keyframe.words});
  });
  return WordIndex(std::move(words));
}

}  // namespace

Result<Atlas> Atlas::restore_part(AtlasPart part) {
  AtlasParts& parts = part.parts;
  auto keyframes =
      Table<KeyFrame, KeyFrameTag>::of_part(std::move(parts.keyframes), part.keyframe_slots);
  if (!keyframes) return Error{"ids of keyframes that cannot be"};
  keep_observations_by(*keyframes, parts.points);
  auto points = Table<MapPoint, MapPointTag>::of_part(std::move(parts.points), part.point_slots);
  if (!points) return Error{"ids of points that cannot be"};
  Atlas atlas(parts.camera, parts.scales);
  atlas.keyframes_ = std::move(*keyframes);
  atlas.points_ = std::move(*points);
  atlas.revision_ = parts.revision;
  atlas.newest_ = parts.newest;
  atlas.next_serial_ = parts.next_serial;
  atlas.maps_ = parts.maps;
  atlas.far_ = std::make_shared<const std::map<KeyFrameId, FarKeyFrame>>(std::move(part.far));
  if (std::string fault = fault_of_keyframes(atlas); !fault.empty()) return Error{std::move(fault)};
  if (std::string fault = fault_of_points(atlas); !fault.empty()) return Error{std::move(fault)};
  if (!link_observations(atlas.keyframes_, atlas.points_)) {
    return Error{"a keypoint that shows two points"};
  }
  link_children(atlas.keyframes_);
  atlas.word_index_ = index_of(atlas.keyframes_);
  return atlas;
}

Result<Atlas> Atlas::restore(AtlasParts parts) {
  auto keyframes =
      Table<KeyFrame, KeyFrameTag>::restore(std::move(parts.keyframes), parts.freed_keyframes);
  auto points = Table<MapPoint, MapPointTag>::restore(std::move(parts.points), parts.freed_points);
  if (!keyframes || !points) return Error{"ids that are missing or given twice"};
  Atlas atlas(parts.camera, parts.scales);
  atlas.keyframes_ = std::move(*keyframes);
  atlas.points_ = std::move(*points);
  atlas.culled_ = CulledKeyFrames(parts.culled);
  atlas.revision_ = parts.revision;
  atlas.newest_ = parts.newest;
  atlas.next_serial_ = parts.next_serial;
  atlas.maps_ = parts.maps;
  if (std::string fault = first_fault(atlas); !fault.empty()) return Error{std::move(fault)};
  if (!link_observations(atlas.keyframes_, atlas.points_)) {
    return Error{"a keypoint that shows two points"};
  }
  link_children(atlas.keyframes_);
  atlas.word_index_ = index_of(atlas.keyframes_);
  std::vector<std::string> faults = atlas.check_consistency();
  if (!faults.empty()) return Error{std::move(faults.front())};
  return atlas;
}

}  // namespace ydd
