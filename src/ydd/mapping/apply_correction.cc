// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/apply_correction.h"

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "ydd/mapping/fuse.h"

namespace ydd {
namespace {

constexpr std::size_t kJunctionNeighbours = 10;

/// The keyframe itself if the correction names it, else the nearest one up the spanning tree that
/// carries it along; empty: it stays.
KeyFrameId corrected_ancestor(const Atlas& atlas, const Correction& correction, KeyFrameId id) {
  while (id.valid() && !correction.T_world_keyframe.contains(id)) {
    const KeyFrame& keyframe = atlas.at(id);
    if (keyframe.serial < correction.newcomers_from) return {};
    id = keyframe.parent;
  }
  return id;
}

/// World motion of a keyframe; nothing if it stays.
std::optional<SE3> motion(const Atlas& atlas, const Correction& correction, KeyFrameId id) {
  const KeyFrameId ancestor = corrected_ancestor(atlas, correction, id);
  if (!ancestor.valid()) return std::nullopt;
  return correction.T_world_keyframe.at(ancestor) * atlas.at(ancestor).T_world_camera.inverse();
}

/// The same of each keyframe, by slot.
std::vector<std::optional<SE3>> motions(const Atlas& atlas, const Correction& correction) {
  std::vector<std::optional<SE3>> T_new_old(atlas.keyframes().slots());
  for (const KeyFrameId id : atlas.keyframes().ids()) {
    T_new_old[id.slot] = motion(atlas, correction, id);
  }
  return T_new_old;
}

using MotionOf = std::function<std::optional<SE3>(KeyFrameId)>;

std::vector<KeyFrameId> surroundings(const Atlas& atlas, KeyFrameId centre) {
  std::vector<KeyFrameId> out{centre};
  for (const Covisible& c : atlas.at(centre).covisible) {
    if (out.size() > kJunctionNeighbours) break;
    out.push_back(c.keyframe);
  }
  return out;
}

std::vector<MapPointId> points_seen_by(const Atlas& atlas, const std::vector<KeyFrameId>& ids) {
  std::vector<MapPointId> points;
  for (const KeyFrameId id : ids) {
    for (const MapPointId point : atlas.at(id).points) {
      if (point.valid()) points.push_back(point);
    }
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

/// The points that move, or are seen by a keyframe that moves.
std::vector<MapPointId> touched_points(const Atlas& atlas, const std::vector<KeyFrameId>& moved,
                                       const Correction& correction) {
  std::vector<MapPointId> points;
  std::vector<bool> listed(atlas.points().slots(), false);
  const auto add = [&](MapPointId id) {
    if (!atlas.find(id) || listed[id.slot]) return;
    listed[id.slot] = true;
    points.push_back(id);
  };
  for (const auto& [id, p_world] : correction.p_world) add(id);
  for (const KeyFrameId id : moved) {
    for (const MapPointId point : atlas.at(id).points) add(point);
  }
  std::sort(points.begin(), points.end());
  return points;
}

void join_maps(Atlas& atlas, const Correction::Junction& junction) {
  const MapId from = atlas.at(junction.current).map;
  const MapId into = atlas.at(junction.matched).map;
  if (from == into) return;
  for (const KeyFrameId id : atlas.keyframes().ids()) {
    if (atlas.at(id).map == from) atlas.set_map(id, into);
  }
  atlas.reroot(junction.current, junction.matched);
}

/// Moves those keyframes by their motion, and those points by that of whoever saw them first.
void move_these(Atlas& atlas, const Correction& correction, const std::vector<KeyFrameId>& moved,
                const std::vector<MapPointId>& touched, const MotionOf& T_new_old) {
  for (const MapPointId id : touched) {
    const MapPoint& point = atlas.at(id);
    const auto placed = correction.p_world.find(id);
    const auto motion = T_new_old(point.observations.front().keyframe);
    if (placed != correction.p_world.end()) {
      atlas.set_position(id, placed->second);
    } else if (motion) {
      atlas.set_position(id, *motion * point.p_world);
    }
  }
  for (const KeyFrameId id : moved) {
    atlas.set_pose(id, *T_new_old(id) * atlas.at(id).T_world_camera);
  }
  for (const MapPointId id : touched) atlas.refresh_point(id);
}

void move_all(Atlas& atlas, const Correction& correction) {
  const std::vector<std::optional<SE3>> T_new_old = motions(atlas, correction);
  std::vector<KeyFrameId> moved;
  for (const KeyFrameId id : atlas.keyframes().ids()) {
    if (T_new_old[id.slot]) moved.push_back(id);
  }
  move_these(atlas, correction, moved, touched_points(atlas, moved, correction),
             [&](KeyFrameId id) { return T_new_old[id.slot]; });
}

/// Motions in the atlas as it was before anything moved.
class Motions {
 public:
  Motions(std::shared_ptr<const Atlas> was, const Correction& correction)
      : was_(std::move(was)), correction_(correction) {}

  std::optional<SE3> operator()(KeyFrameId id) {
    const auto [entry, is_new] = known_.try_emplace(id);
    if (is_new) entry->second = motion(*was_, correction_, id);
    return entry->second;
  }

 private:
  std::shared_ptr<const Atlas> was_;
  const Correction& correction_;
  std::map<KeyFrameId, std::optional<SE3>> known_;
};

/// Most of the map is moved already; what is newer than that has to follow.
void apply_prepared(Atlas& atlas, const Correction& correction) {
  Motions motion_of(atlas.snapshot(), correction);
  Atlas::Newer newer =
      atlas.adopt_places(*correction.prepared->before, *correction.prepared->after);
  std::erase_if(newer.keyframes, [&](KeyFrameId id) { return !motion_of(id); });
  // Descriptors and viewing directions of what moving keyframes see depend on where these stand.
  std::erase_if(newer.points, [&](MapPointId id) {
    const auto& all = atlas.at(id).observations;
    return !correction.p_world.contains(id) &&
           std::none_of(all.begin(), all.end(),
                        [&](const auto& o) { return motion_of(o.keyframe); });
  });
  move_these(atlas, correction, newer.keyframes, newer.points, std::ref(motion_of));
  std::vector<MapPointId> seen = points_seen_by(atlas, newer.keyframes);
  std::erase_if(seen, [&](MapPointId id) {
    return std::binary_search(newer.points.begin(), newer.points.end(), id);
  });
  for (const MapPointId id : seen) atlas.refresh_point(id);
}

}  // namespace

void apply_correction(Atlas& atlas, const Correction& correction) {
  if (correction.prepared) {
    apply_prepared(atlas, correction);
  } else {
    move_all(atlas, correction);
  }
}

void prepare_correction(std::shared_ptr<const Atlas> before, Correction& correction) {
  auto after = std::make_shared<Atlas>(before->fork());
  move_all(*after, correction);
  correction.prepared = Correction::Prepared{std::move(before), std::move(after)};
}

void merge_at(Atlas& atlas, const Correction::Junction& junction, double radius_px,
              int min_covisible_weight, const MatchLimits& limits) {
  if (!atlas.find(junction.current) || !atlas.find(junction.matched)) return;  // culled meanwhile
  join_maps(atlas, junction);
  atlas.add_loop(junction.current, junction.matched);
  const std::vector<KeyFrameId> current = surroundings(atlas, junction.current);
  const std::vector<MapPointId> theirs =
      points_seen_by(atlas, surroundings(atlas, junction.matched));
  for (const KeyFrameId id : current) fuse_points(atlas, id, theirs, radius_px, limits);
  for (const KeyFrameId id : current) atlas.refresh_covisibility(id, min_covisible_weight);
}

}  // namespace ydd
