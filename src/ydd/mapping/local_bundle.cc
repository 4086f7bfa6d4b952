// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/local_bundle.h"

#include <algorithm>
#include <map>

namespace ydd {
namespace {

void add_free_poses(const Atlas& atlas, KeyFrameId centre, const LocalBundleOptions& options,
                    std::span<const KeyFrameId> along, PoseIndex& index, GatheredBundle& gathered) {
  add_pose(atlas, centre, atlas.is_first(centre), index, gathered);
  for (const KeyFrameId id : along) {
    if (!index.has(id)) add_pose(atlas, id, atlas.is_first(id), index, gathered);
  }
  for (const Covisible& c : atlas.at(centre).covisible) {
    if (static_cast<int>(gathered.keyframes.size()) >= options.max_free_keyframes) break;
    if (index.has(c.keyframe)) continue;
    add_pose(atlas, c.keyframe, atlas.is_first(c.keyframe), index, gathered);
  }
}

void add_points(const Atlas& atlas, GatheredBundle& gathered) {
  std::vector<bool> seen(atlas.points().slots(), false);
  for (const KeyFrameId id : gathered.keyframes) {
    for (const MapPointId point : atlas.at(id).points) {
      if (!point.valid() || seen[point.slot]) continue;
      seen[point.slot] = true;
      add_point(atlas, point, gathered);
    }
  }
}

/// Outside keyframes that see the points, those that see most first.
std::vector<KeyFrameId> outside_keyframes(const Atlas& atlas, const GatheredBundle& gathered,
                                          const PoseIndex& index) {
  std::map<KeyFrameId, int> votes;
  for (const MapPointId point : gathered.points) {
    for (const Observation& s : atlas.at(point).observations) {
      if (!index.has(s.keyframe)) ++votes[s.keyframe];
    }
  }
  std::vector<KeyFrameId> out;
  for (const auto& [id, count] : votes) out.push_back(id);
  std::stable_sort(out.begin(), out.end(),
                   [&](KeyFrameId a, KeyFrameId b) { return votes[a] > votes[b]; });
  return out;
}

}  // namespace

void LocalBundleOptions::describe(OptionTable& t) {
  t.group("solver", solver);
  t.add("max_free_keyframes", max_free_keyframes, {1, 1000}, "", "keyframes that are adjusted");
  t.add("max_fixed_keyframes", max_fixed_keyframes, {1, 1000}, "",
        "keyframes that hold the frame of reference");
}

GatheredBundle gather_local_bundle(const Atlas& atlas, KeyFrameId keyframe,
                                   const LocalBundleOptions& options,
                                   std::span<const KeyFrameId> along) {
  GatheredBundle gathered;
  PoseIndex index(atlas);
  add_free_poses(atlas, keyframe, options, along, index, gathered);
  add_points(atlas, gathered);
  int fixed = 0;
  for (const KeyFrameId id : outside_keyframes(atlas, gathered, index)) {
    if (++fixed > options.max_fixed_keyframes) break;
    add_pose(atlas, id, true, index, gathered);
  }
  // Without any fixed pose the whole problem could float: the oldest keyframe holds it.
  auto& poses = gathered.problem.poses;
  if (std::none_of(poses.begin(), poses.end(), [](const auto& p) { return p.fixed; })) {
    std::size_t oldest = 0;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const auto serial = [&](std::size_t k) { return atlas.at(gathered.keyframes[k]).serial; };
      if (serial(i) < serial(oldest)) oldest = i;
    }
    poses[oldest].fixed = true;
  }
  add_observations(atlas, index, gathered);
  return gathered;
}

void apply_bundle(Atlas& atlas, const GatheredBundle& gathered, const BundleResult& result) {
  for (std::size_t i = 0; i < gathered.keyframes.size(); ++i) {
    if (gathered.problem.poses[i].fixed) continue;
    atlas.set_pose(gathered.keyframes[i], result.T_camera_world[i].inverse());
  }
  for (std::size_t i = 0; i < gathered.points.size(); ++i) {
    atlas.set_position(gathered.points[i], result.points[i]);
  }
  for (std::size_t i = 0; i < gathered.problem.observations.size(); ++i) {
    if (result.inlier[i] != 0) continue;
    const BundleProblem::Observation& o = gathered.problem.observations[i];
    const MapPointId point = gathered.points[static_cast<std::size_t>(o.point)];
    if (atlas.find(point)) {
      atlas.remove_observation(point, gathered.keyframes[static_cast<std::size_t>(o.pose)]);
    }
  }
  for (const MapPointId point : gathered.points) {
    if (atlas.find(point)) atlas.refresh_point(point);
  }
}

}  // namespace ydd
