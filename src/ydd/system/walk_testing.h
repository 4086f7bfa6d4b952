// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ydd/mapping/mapper.h"
#include "ydd/matching/matching_testing.h"
#include "ydd/tracking/tracker.h"

/// A camera that walks through a testing world, for the tests of tracking and mapping together.
namespace ydd::testing_world {

/// Tracker and camera; whoever maps gets the candidates.
class Walker {
 public:
  explicit Walker(unsigned seed = 8, const TrackerOptions& options = {})
      : world_(make_world(1200, seed)), tracker_(options) {}

  static SE3 path(std::int64_t index) { return hand_held(static_cast<double>(index) / 30.0); }

  /// Tracks the next frame against `atlas`.
  TrackResult step(const Atlas& atlas, bool mapper_idle = true) {
    ViewOptions options;
    options.noise_px = 0.5;
    options.depth_noise = 0.002;
    options.flipped_bits = 15;
    options.depth_reading_m = 3.5;
    options.seed = static_cast<unsigned>(index_);
    const View view = look(world_, path(index_), options);
    return tracker_.track(frame_of(view, index_++), atlas, mapper_idle);
  }

  const PointWorld& world() const { return world_; }

 private:
  PointWorld world_;
  Tracker tracker_;
  std::int64_t index_ = 0;
};

/// A keyframe candidate that says where it stands relative to `reference`.
inline KeyFrameCandidate candidate_of(const View& view, std::int64_t index, KeyFrameId reference,
                                      const SE3& T_reference_camera) {
  KeyFrameCandidate candidate{frame_of(view, index), reference, T_reference_camera, {}};
  candidate.frame.T_camera_world = view.T_world_camera.inverse();
  return candidate;
}

}  // namespace ydd::testing_world
