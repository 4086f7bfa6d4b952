// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/merge_maps.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "ydd/map/join_atlases.h"

namespace ydd {
namespace {

/// Keyframes of a map in the order of creation.
std::vector<KeyFrameId> keyframes_of(const Atlas& atlas, MapId map) {
  std::vector<KeyFrameId> out;
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (keyframe.map == map) out.push_back(id);
  });
  std::sort(out.begin(), out.end(),
            [&](KeyFrameId x, KeyFrameId y) { return atlas.at(x).serial < atlas.at(y).serial; });
  return out;
}

std::set<MapId> maps_of(const Atlas& atlas) {
  std::set<MapId> out;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& k) { out.insert(k.map); });
  return out;
}

/// The common place with most agreeing points.
std::optional<LoopMatch> best_match(const Atlas& atlas, MapId map, const std::set<MapId>& into,
                                    const LoopOptions& options) {
  std::optional<LoopMatch> best;
  const auto among = [&](KeyFrameId id) { return into.contains(atlas.at(id).map); };
  for (const KeyFrameId id : keyframes_of(atlas, map)) {
    const auto match = find_loop(atlas, id, options, among);
    if (match && (!best || match->seen.size() > best->seen.size())) best = match;
  }
  return best;
}

/// Of some keyframes those that stand and look as one of the others does.
std::size_t count_overlapping(const Atlas& atlas, const std::vector<KeyFrameId>& moved,
                              const std::vector<KeyFrameId>& others) {
  constexpr double kNear_m = 1.0;
  const double near_cosine = std::cos(std::numbers::pi / 6.0);
  const auto overlaps = [&](KeyFrameId id) {
    const SE3& pose = atlas.at(id).T_world_camera;
    const Eigen::Vector3d ahead = pose.rotation() * Eigen::Vector3d::UnitZ();
    return std::any_of(others.begin(), others.end(), [&](KeyFrameId other) {
      const SE3& there = atlas.at(other).T_world_camera;
      return (there.translation() - pose.translation()).norm() < kNear_m &&
             ahead.dot(there.rotation() * Eigen::Vector3d::UnitZ()) > near_cosine;
    });
  };
  return static_cast<std::size_t>(std::count_if(moved.begin(), moved.end(), overlaps));
}

/// Nobody else works on the map: what was computed on it fits it.
void apply_to(Mapper& mapper, const std::optional<Correction>& correction) {
  if (!correction || mapper.apply(*correction) != Applied::as_computed) {
    throw std::logic_error("merge_maps: a map that moved by itself");
  }
}

}  // namespace

Result<MergedMaps> merge_maps(const Atlas& a, const Atlas& b, const MapperOptions& mapping,
                              const LoopOptions& loop) {
  Result<Atlas> joined = join_atlases(a, b);
  if (!joined) return joined.error();
  const std::set<MapId> first = maps_of(a);
  std::set<MapId> second = maps_of(*joined);
  for (const MapId map : first) second.erase(map);
  Mapper mapper(std::move(*joined), mapping);
  MergedMaps out{Atlas(a.camera(), a.scales()), {}, 0};
  for (const MapId map : second) {
    const auto atlas = mapper.snapshot();
    const auto match = best_match(*atlas, map, first, loop);
    if (!match) {
      ++out.separate;
      continue;
    }
    const MapId into = atlas->at(match->matched).map;
    const std::vector<KeyFrameId> moved = keyframes_of(*atlas, map);
    const std::vector<KeyFrameId> others = keyframes_of(*atlas, into);
    apply_to(mapper, correct_loop(*atlas, *match, loop));
    if (loop.full_bundle) apply_to(mapper, full_bundle(*mapper.snapshot(), match->matched, loop));
    out.merges.push_back({map, into, match->seen.size(), moved.size(),
                          count_overlapping(mapper.atlas(), moved, others)});
  }
  out.atlas = std::move(mapper).take_atlas();
  return out;
}

}  // namespace ydd
