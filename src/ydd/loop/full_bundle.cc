// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "ydd/loop/loop_closer.h"
#include "ydd/matching/gathered_bundle.h"

namespace ydd {
namespace {

/// The whole map; its first keyframe is fixed.
GatheredBundle gather_map(const Atlas& atlas, MapId map) {
  GatheredBundle gathered;
  PoseIndex index(atlas);
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (keyframe.map == map) add_pose(atlas, id, atlas.is_first(id), index, gathered);
  });
  atlas.points().for_each([&](MapPointId id, const MapPoint& point) {
    const auto& all = point.observations;
    if (std::any_of(all.begin(), all.end(), [&](const auto& o) { return index.has(o.keyframe); })) {
      add_point(atlas, id, gathered);
    }
  });
  add_observations(atlas, index, gathered);
  return gathered;
}

}  // namespace

std::optional<Correction> full_bundle(const Atlas& atlas, KeyFrameId member,
                                      const LoopOptions& options, const std::stop_token& stop) {
  const KeyFrame* keyframe = atlas.find(member);
  if (!keyframe) return std::nullopt;
  const GatheredBundle gathered = gather_map(atlas, keyframe->map);
  const BundleResult solved = solve_bundle(atlas.camera(), gathered.problem, options.bundle, stop);
  if (solved.interrupted) return std::nullopt;
  Correction correction;
  correction.revision = atlas.revision();
  for (std::size_t i = 0; i < gathered.keyframes.size(); ++i) {
    correction.T_world_keyframe[gathered.keyframes[i]] = solved.T_camera_world[i].inverse();
  }
  for (std::size_t i = 0; i < gathered.points.size(); ++i) {
    correction.p_world[gathered.points[i]] = solved.points[i];
  }
  return correction;
}

}  // namespace ydd
