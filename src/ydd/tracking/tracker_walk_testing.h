// SPDX-License-Identifier: Apache-2.0
// A tracker that is carried through a world of points, for tests.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "ydd/matching/matching_testing.h"
#include "ydd/tracking/tracker.h"

namespace ydd::testing_world {

/// Takes keyframes into a map and makes points from depth; nothing is refined.
class PlainMapper {
 public:
  explicit PlainMapper(const PointWorld& world) : atlas_(world.camera, world.scales) {}

  void take(const KeyFrameCandidate& candidate) {
    const TrackedFrame& frame = candidate.frame;
    KeyFrame keyframe;
    keyframe.frame_index = frame.index;
    keyframe.stamp = frame.stamp;
    keyframe.shared_features = frame.shared_features;
    keyframe.grid = frame.grid;
    keyframe.points = frame.points;
    keyframe.T_world_camera = frame.T_camera_world.inverse();
    keyframe.parent = candidate.reference;
    keyframe.map =
        candidate.reference.valid() ? atlas_.at(candidate.reference).map : atlas_.new_map();
    const KeyFrameId id = atlas_.add_keyframe(keyframe);
    const Features& f = frame.features();
    for (std::size_t i = 0; i < f.size(); ++i) {
      if (atlas_.at(id).points[i].valid() || !f.has_depth(i)) continue;
      const Eigen::Vector3d p_camera =
          atlas_.camera().unproject(f.undistorted_px[i].cast<double>(), f.depth_m[i]);
      atlas_.add_point(keyframe.T_world_camera * p_camera, id, static_cast<int>(i));
    }
    atlas_.refresh_covisibility(id, 15);
  }
  Atlas& atlas() { return atlas_; }

 private:
  Atlas atlas_;
};

/// Camera, tracker and map in one hand.
class Walk {
 public:
  explicit Walk(TrackerOptions options = {}) : tracker_(options), mapper_(world_) {}

  /// Switched off and on again: the map stays, what the tracker knew is gone.
  void restart(const TrackerOptions& options = {}) { tracker_ = Tracker(options, true); }
  Tracker& tracker() { return tracker_; }

  /// Tracks the next frame, seen from `T_world_camera`.
  TrackResult step(const SE3& T_world_camera, double seen_share = 1.0) {
    return step_in(world_, T_world_camera, seen_share);
  }
  /// The same in another place, where nothing looks familiar.
  TrackResult step_elsewhere() { return step_in(elsewhere_, path(index_), 1.0); }
  TrackResult step_in(const PointWorld& world, const SE3& T_world_camera, double seen_share) {
    ViewOptions look_options;
    look_options.noise_px = 0.5;
    look_options.depth_noise = 0.002;
    look_options.flipped_bits = 15;
    look_options.seen_share = seen_share;
    look_options.seed = static_cast<unsigned>(index_);
    view_ = look(world, T_world_camera, look_options);
    TrackedFrame frame = frame_of(view_, index_++);
    if (seen_index_ && senses_) frame.reckoned = senses_(*seen_index_, frame.index);
    TrackResult result = tracker_.track(std::move(frame), mapper_.atlas(), true);
    const bool seen =
        result.state == TrackingState::tracking || (result.reference.valid() && !result.reckoned);
    if (seen) seen_index_ = index_ - 1;
    if (result.candidate) mapper_.take(*result.candidate);
    return result;
  }
  TrackResult step() { return step(path(index_)); }
  TrackResult step_blind() { return step(path(index_), 0.0); }
  static SE3 path(std::int64_t index) { return hand_held(static_cast<double>(index) / 30.0); }

  /// What other senses say of the motion from one frame to another.
  using Senses = std::function<ReckonedMotion(std::int64_t then, std::int64_t now)>;
  void set_senses(Senses senses) { senses_ = std::move(senses); }

  const PointWorld& world() const { return world_; }
  const View& view() const { return view_; }
  Atlas& atlas() { return mapper_.atlas(); }
  const Tracker& tracker() const { return tracker_; }

 private:
  PointWorld world_ = make_world(1200, 8);
  PointWorld elsewhere_ = make_world(1200, 80);
  Tracker tracker_;
  PlainMapper mapper_;
  View view_;
  std::int64_t index_ = 0;
  Senses senses_;
  std::optional<std::int64_t> seen_index_;  ///< of the last frame whose pose was seen
};

}  // namespace ydd::testing_world
