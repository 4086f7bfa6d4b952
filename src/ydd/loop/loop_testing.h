// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ydd/loop/loop_closer.h"
#include "ydd/map/world_testing.h"

/// A map whose camera comes to the same place twice, for the tests of loops and of the system.
namespace ydd::testing_world {

inline constexpr int kOldViews = 14;
inline constexpr int kNewViews = 6;

/// A map of a place, and a stretch of keyframes that sees a place later without knowing the first:
/// it has points of its own, displaced by `drift`.
struct TwoVisits {
  Atlas atlas;
  MapId first_map;
  std::vector<KeyFrameId> old_keyframes, new_keyframes;
  std::vector<SE3> T_world_new;  ///< true poses
};

inline KeyFrame described(const View& view, std::int64_t frame, MapId map) {
  KeyFrame keyframe = keyframe_of(view, frame);
  keyframe.map = map;
  keyframe.words = std::make_shared<const BagOfWords>(
      bag_of_words(builtin_vocabulary(), view.features().descriptors));
  return keyframe;
}

/// Adds keyframes of views, with points of their own where `drift` puts them.
inline std::vector<KeyFrameId> add_visit(Atlas& atlas, const PointWorld& world,
                                         const std::vector<View>& views, const SE3& drift,
                                         MapId map, KeyFrameId parent) {
  std::vector<KeyFrameId> ids;
  std::vector<MapPointId> points(world.p_world.size());
  for (const View& view : views) {
    KeyFrame keyframe = described(view, static_cast<std::int64_t>(atlas.keyframes().size()), map);
    keyframe.T_world_camera = drift * view.T_world_camera;
    keyframe.parent = ids.empty() ? parent : ids.back();
    const KeyFrameId id = atlas.add_keyframe(std::move(keyframe));
    for (std::size_t k = 0; k < view.shown.size(); ++k) {
      MapPointId& point = points[static_cast<std::size_t>(view.shown[k])];
      if (point.valid()) {
        atlas.add_observation(point, id, static_cast<int>(k));
      } else {
        point = atlas.add_point(drift * world.p_world[static_cast<std::size_t>(view.shown[k])], id,
                                static_cast<int>(k));
      }
    }
    ids.push_back(id);
  }
  for (const KeyFrameId id : ids) atlas.refresh_covisibility(id, 15);
  for (const MapPointId id : points) {
    if (id.valid()) atlas.refresh_point(id);
  }
  return ids;
}

inline std::vector<View> views_of(const PointWorld& world, int count, double start_s,
                                  unsigned seed) {
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    ViewOptions options;
    options.noise_px = 0.3;
    options.flipped_bits = 12;
    options.seed = seed + static_cast<unsigned>(i);
    views.push_back(look(world, hand_held(start_s + 0.2 * i), options));
  }
  return views;
}

/// `same_place`: the second visit sees the first one's world, else a stranger.
inline TwoVisits two_visits(const SE3& drift, bool same_place, bool own_map = false) {
  const PointWorld world = make_world(700, 3);
  const PointWorld stranger = make_world(700, 4);
  TwoVisits visits{Atlas(world.camera, world.scales), {}, {}, {}, {}};
  visits.first_map = visits.atlas.new_map();
  visits.old_keyframes = add_visit(visits.atlas, world, views_of(world, kOldViews, 0.0, 1), SE3(),
                                   visits.first_map, {});
  const PointWorld& seen = same_place ? world : stranger;
  const std::vector<View> views = views_of(seen, kNewViews, 0.1, 101);
  for (const View& view : views) visits.T_world_new.push_back(view.T_world_camera);
  const MapId map = own_map ? visits.atlas.new_map() : visits.first_map;
  visits.new_keyframes = add_visit(visits.atlas, seen, views, drift, map,
                                   own_map ? KeyFrameId{} : visits.old_keyframes.back());
  return visits;
}

inline LoopOptions quick_options() {
  LoopOptions options;
  options.min_age_keyframes = 3;
  options.min_score_ratio = 0.5;
  options.max_drift_m = 2.0;  // the way is short, the drift of these tests is not
  return options;
}

inline SE3 small_drift() {
  Vector6d twist;
  twist << 0.4, -0.1, 0.3, 0.02, 0.05, -0.03;
  return SE3::exp(twist);
}

}  // namespace ydd::testing_world
