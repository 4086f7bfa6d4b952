// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "ydd/loop/loop_testing.h"
#include "ydd/system/mapping_runner.h"
#include "ydd/system/walk_testing.h"

/// A camera that is about to close a loop, for the tests of runners.
namespace ydd::testing_world {

/// The second visit to a place goes on: whose keyframes come next closes the loop.
class SecondVisit {
 public:
  SecondVisit()
      : visits_(two_visits(drift(), true)),
        newest_(views_of(world_, kNewViews, 0.1, 101).back()),
        points_of_newest_(visits_.atlas.at(visits_.new_keyframes.back()).points) {}

  /// Who is to map what follows; once.
  Mapper take_mapper() { return {std::move(visits_.atlas), MapperOptions()}; }
  /// Hands over the next keyframe. False if it was not taken.
  Result<bool> submit_next(MappingRunner& runner) {
    ViewOptions options;
    options.noise_px = 0.3;
    options.flipped_bits = 12;
    options.seed = 301U + static_cast<unsigned>(steps_);
    const View view = look(world_, hand_held(0.1 + 0.2 * (kNewViews + steps_)), options);
    const KeyFrameId reference = visits_.new_keyframes.back();
    KeyFrameCandidate candidate = candidate_of(
        view, 100 + steps_, reference, visits_.T_world_new.back().inverse() * view.T_world_camera);
    candidate.frame.points = points_in(view);
    ++steps_;
    return runner.submit(std::move(candidate));
  }
  /// How far the second visit is from where it truly was.
  double error_m(const Atlas& atlas) const {
    const auto T_world_newest = atlas.T_world_keyframe(visits_.new_keyframes.back());
    return position_error_m(*T_world_newest, visits_.T_world_new.back());
  }

 private:
  /// Small enough for the points of both visits to be fused when the pose graph has taken its part.
  static SE3 drift() {
    Vector6d twist;
    twist << 0.12, -0.03, 0.09, 0.006, 0.015, -0.009;
    return SE3::exp(twist);
  }
  /// The points of the map that a look shows, as far as the newest keyframe of the visit sees them.
  std::vector<MapPointId> points_in(const View& view) const {
    std::vector<MapPointId> points;
    for (const int shown : view.shown) {
      const auto it = std::find(newest_.shown.begin(), newest_.shown.end(), shown);
      points.push_back(
          it == newest_.shown.end()
              ? MapPointId{}
              : points_of_newest_[static_cast<std::size_t>(it - newest_.shown.begin())]);
    }
    return points;
  }

  PointWorld world_ = make_world(700, 3);  // as in two_visits
  TwoVisits visits_;
  View newest_;  ///< as the newest keyframe of the visit sees it
  std::vector<MapPointId> points_of_newest_;
  int steps_ = 0;
};

}  // namespace ydd::testing_world
