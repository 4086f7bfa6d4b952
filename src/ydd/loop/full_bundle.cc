// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

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

std::size_t size_of(const Atlas& atlas, MapId map) {
  std::size_t size = 0;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& k) { size += k.map == map ? 1 : 0; });
  return size;
}

/// So many keyframes of a map, nearest first by steps along shared points, loops and the tree.
std::vector<KeyFrameId> neighbourhood(const Atlas& atlas, KeyFrameId centre, std::size_t wanted) {
  std::vector<KeyFrameId> out{centre};
  std::vector<bool> reached(atlas.keyframes().slots(), false);
  reached[centre.slot] = true;
  for (std::size_t at = 0; at < out.size() && out.size() < wanted; ++at) {
    const KeyFrame& keyframe = atlas.at(out[at]);
    const auto step = [&](KeyFrameId id) {
      const KeyFrame* const next = atlas.find(id);
      if (!next || next->map != keyframe.map || reached[id.slot] || out.size() == wanted) return;
      reached[id.slot] = true;
      out.push_back(id);
    };
    for (const Covisible& c : keyframe.covisible) step(c.keyframe);
    for (const KeyFrameId id : keyframe.loops) step(id);
    step(keyframe.parent);
    for (const KeyFrameId id : keyframe.children) step(id);
  }
  return out;
}

/// Keyframes outside of the bundle that see its points, those that see most first.
std::vector<KeyFrameId> onlookers(const Atlas& atlas, const PoseIndex& index,
                                  const GatheredBundle& gathered) {
  std::map<KeyFrameId, int> votes;
  for (const MapPointId point : gathered.points) {
    for (const Observation& o : atlas.at(point).observations) {
      if (!index.has(o.keyframe)) ++votes[o.keyframe];
    }
  }
  std::vector<KeyFrameId> out;
  for (const auto& [id, count] : votes) out.push_back(id);
  std::stable_sort(out.begin(), out.end(),
                   [&](KeyFrameId a, KeyFrameId b) { return votes[a] > votes[b]; });
  return out;
}

/// A part of a map; what sees its points from outside holds it.
GatheredBundle gather_window(const Atlas& atlas, const std::vector<KeyFrameId>& window) {
  GatheredBundle gathered;
  PoseIndex index(atlas);
  std::vector<bool> seen(atlas.points().slots(), false);
  for (const KeyFrameId id : window) add_pose(atlas, id, atlas.is_first(id), index, gathered);
  for (const KeyFrameId id : window) {
    for (const MapPointId point : atlas.at(id).points) {
      if (!point.valid() || seen[point.slot]) continue;
      seen[point.slot] = true;
      add_point(atlas, point, gathered);
    }
  }
  std::vector<KeyFrameId> outside = onlookers(atlas, index, gathered);
  outside.resize(std::min(outside.size(), window.size()));
  for (const KeyFrameId id : outside) add_pose(atlas, id, true, index, gathered);
  // The last reached is the farthest from the loop: should nobody look on, it holds the rest.
  if (outside.empty()) gathered.problem.poses.back().fixed = true;
  add_observations(atlas, index, gathered);
  return gathered;
}

}  // namespace

std::optional<Correction> full_bundle(const Atlas& atlas, KeyFrameId member,
                                      const LoopOptions& options, const std::stop_token& stop,
                                      const BundleWatch& watch) {
  const KeyFrame* keyframe = atlas.find(member);
  if (!keyframe) return std::nullopt;
  const auto most = static_cast<std::size_t>(options.bundle_keyframes);
  const GatheredBundle gathered = size_of(atlas, keyframe->map) <= most
                                      ? gather_map(atlas, keyframe->map)
                                      : gather_window(atlas, neighbourhood(atlas, member, most));
  const BundleResult solved =
      solve_bundle(atlas.camera(), gathered.problem, options.bundle, stop, watch);
  if (solved.interrupted && !(solved.final_cost < solved.initial_cost)) return std::nullopt;
  Correction correction;
  correction.revision = atlas.revision();
  correction.newcomers_from = atlas.next_serial();
  for (std::size_t i = 0; i < gathered.keyframes.size(); ++i) {
    const KeyFrameId id = gathered.keyframes[i];
    const bool stays = gathered.problem.poses[i].fixed && !atlas.is_first(id);
    if (!stays) correction.T_world_keyframe[id] = solved.T_camera_world[i].inverse();
  }
  for (std::size_t i = 0; i < gathered.points.size(); ++i) {
    correction.p_world[gathered.points[i]] = solved.points[i];
  }
  return correction;
}

}  // namespace ydd
