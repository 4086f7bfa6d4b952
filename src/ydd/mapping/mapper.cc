// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/mapper.h"

#include <algorithm>
#include <utility>

#include "ydd/mapping/apply_correction.h"
#include "ydd/mapping/fuse.h"

namespace ydd {

void MapperOptions::describe(OptionTable& t) {
  t.group("bundle", bundle);
  t.group("inertial", inertial);
  t.group("cull", cull);
  t.group("triangulation", triangulation);
  t.group("match", match);
  t.add("min_covisible_weight", min_covisible_weight, {1, 1000}, "",
        "shared points that connect two keyframes");
  t.add("min_depth_points", min_depth_points, {0, 10000}, "",
        "so many points are made from the nearest depth readings in any case");
  t.add("fuse_neighbours", fuse_neighbours, {0, 100}, "", "keyframes whose points are fused");
  t.add("fuse_radius_px", fuse_radius_px, {0.5, 50.0}, "px",
        "search radius for fusing on octave 0");
}

Mapper::Mapper(const Camera& camera, const PyramidScales& scales, const MapperOptions& options)
    : Mapper(Atlas(camera, scales), options) {}

Mapper::Mapper(Atlas atlas, const MapperOptions& options)
    : options_(options), atlas_(std::move(atlas)), inertial_(options.inertial) {
  // What was on probation when the map was saved still is.
  const std::int64_t from = atlas_.next_serial() - 1 - options_.cull.probation_keyframes;
  atlas_.points().for_each([&](MapPointId id, const MapPoint& point) {
    if (point.born >= from) recent_points_.push_back(id);
  });
}

MapperReport Mapper::process(const KeyFrameCandidate& candidate, std::stop_token stop) {
  MapperReport report;
  const auto timed = [&](const char* stage, auto&& step) {
    StageTimer timer(report.times, stage);
    return step();
  };
  const KeyFrameId id = report.keyframe =
      timed("insert_keyframe", [&] { return insert(candidate); });
  if (options_.inertial.enabled) inertial_.enter(atlas_, id, candidate.imu);
  report.points_culled = timed("cull_points", [&] {
    return cull_contradicted_points(atlas_, candidate.views, options_.cull) +
           cull_recent_points(atlas_, recent_points_, id, options_.cull);
  });
  report.points_from_depth = timed("create_points", [&] {
    const int added = add_points_from_depth(id);
    const auto triangulated =
        triangulate_with_neighbours(atlas_, id, options_.triangulation, options_.match);
    recent_points_.insert(recent_points_.end(), triangulated.begin(), triangulated.end());
    report.points_triangulated = static_cast<int>(triangulated.size());
    return added;
  });
  report.points_fused = timed("fuse_points", [&] {
    return fuse_with_neighbours(atlas_, id, options_.fuse_neighbours, options_.fuse_radius_px,
                                options_.min_covisible_weight, options_.match);
  });
  timed("local_bundle", [&] {
    if (atlas_.keyframes().size() < 2) return;
    const std::vector<KeyFrameId> along = inertial_.keyframes();
    GatheredBundle gathered = gather_local_bundle(atlas_, id, options_.bundle, along);
    gathered.problem.inertial = inertial_.problem(gathered);
    const BundleResult result =
        solve_bundle(atlas_.camera(), gathered.problem, options_.bundle.solver, stop);
    apply_bundle(atlas_, gathered, result);
    inertial_.take(gathered, result);
  });
  report.keyframes_culled = timed("cull_keyframes", [&] {
    const int redundant = cull_redundant_keyframes(atlas_, id, options_.cull);
    return redundant + cull_crowded_place(atlas_, id, options_.cull);
  });
  return report;
}

Applied Mapper::apply(const Correction& correction) {
  const std::set<MapId> maps = maps_of(correction);
  for (const MapId map : maps) {
    const auto corrected = corrected_.find(map);
    if (corrected != corrected_.end() && corrected->second > correction.revision) {
      return Applied::refused;
    }
  }
  const bool moved_on = atlas_.revision() != correction.revision;
  const std::vector<Eigen::Quaterniond> before = inertial_.rotations(atlas_);
  apply_correction(atlas_, correction);
  inertial_.turned(before, atlas_);
  if (correction.junction) {
    merge_at(atlas_, *correction.junction, options_.fuse_radius_px, options_.min_covisible_weight,
             options_.match);
  }
  for (const MapId map : maps) corrected_[map] = atlas_.revision();
  return moved_on ? Applied::rebased : Applied::as_computed;
}

/// The maps that it moves, or places something in relation to.
std::set<MapId> Mapper::maps_of(const Correction& correction) const {
  std::set<MapId> maps;
  const auto add = [&](KeyFrameId id) {
    if (const KeyFrame* const keyframe = atlas_.find(id)) maps.insert(keyframe->map);
  };
  for (const auto& [id, T_world_keyframe] : correction.T_world_keyframe) add(id);
  if (correction.junction) {
    add(correction.junction->current);
    add(correction.junction->matched);
  }
  return maps;
}

KeyFrameId Mapper::insert(const KeyFrameCandidate& candidate) {
  const TrackedFrame& frame = candidate.frame;
  KeyFrame keyframe;
  keyframe.frame_index = frame.index;
  keyframe.stamp = frame.stamp;
  keyframe.shared_features = frame.shared_features;
  keyframe.grid = frame.grid;
  keyframe.points = frame.points;
  if (frame.picture) {
    keyframe.picture =
        std::make_shared<const KeyFramePicture>(make_keyframe_picture(*frame.picture));
  }
  keyframe.words = std::make_shared<const BagOfWords>(
      bag_of_words(builtin_vocabulary(), frame.features().descriptors));
  const auto T_world_reference = atlas_.T_world_keyframe(candidate.reference);
  // It may also have been culled; then the keyframe that it hangs on stands in.
  const KeyFrameId reference_id = atlas_.nearest_kept(candidate.reference);
  const KeyFrame* reference = atlas_.find(reference_id);
  keyframe.map = reference ? reference->map : atlas_.new_map();
  // The reference may have moved since the frame was tracked: keep the relation, not the number.
  keyframe.T_world_camera = T_world_reference ? *T_world_reference * candidate.T_reference_camera
                                              : frame.T_camera_world.inverse();
  const KeyFrameId id = atlas_.add_keyframe(std::move(keyframe));
  const std::vector<MapPointId> points = atlas_.at(id).points;
  for (const MapPointId point : points) {
    if (point.valid()) atlas_.refresh_point(point);
  }
  for (const PointViews& views : candidate.views) {
    if (atlas_.find(views.point)) atlas_.count_views(views.point, views.visible, views.found);
  }
  atlas_.refresh_covisibility(id, options_.min_covisible_weight);
  if (reference_id.valid() && !atlas_.at(id).parent.valid()) atlas_.set_parent(id, reference_id);
  return id;
}

int Mapper::add_points_from_depth(KeyFrameId id) {
  const auto features = atlas_.at(id).shared_features;  // shared: edits may move the keyframe
  const Features& f = *features;
  std::vector<int> order;
  for (int i = 0; i < static_cast<int>(f.size()); ++i) {
    if (f.has_depth(static_cast<std::size_t>(i))) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return f.depth_m[static_cast<std::size_t>(a)] < f.depth_m[static_cast<std::size_t>(b)];
  });
  int created = 0;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const auto i = static_cast<std::size_t>(order[rank]);
    if (f.depth_m[i] > options_.close_depth_m &&
        static_cast<int>(rank) >= options_.min_depth_points) {
      break;
    }
    const KeyFrame& keyframe = atlas_.at(id);
    if (keyframe.points[i].valid()) continue;
    const Eigen::Vector3d p_world =
        keyframe.T_world_camera *
        atlas_.camera().unproject(f.undistorted_px[i].cast<double>(), f.depth_m[i]);
    recent_points_.push_back(atlas_.add_point(p_world, id, order[rank]));
    ++created;
  }
  return created;
}

}  // namespace ydd
