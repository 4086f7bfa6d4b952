// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/map/atlas.h"
#include "ydd/optimization/bundle_adjustment.h"

namespace ydd {

/// A bundle problem, and which keyframe and point of the map each of its parts is.
struct GatheredBundle {
  BundleProblem problem;
  std::vector<KeyFrameId> keyframes;  ///< parallel to problem.poses
  std::vector<MapPointId> points;     ///< parallel to problem.points
};

/// Which pose of a problem a keyframe is, by slot; absent where it is none.
class PoseIndex {
 public:
  explicit PoseIndex(const Atlas& atlas) : by_slot_(atlas.keyframes().slots(), kAbsent) {}

  void set(KeyFrameId id, int pose) { by_slot_[id.slot] = pose; }
  int of(KeyFrameId id) const { return by_slot_[id.slot]; }
  bool has(KeyFrameId id) const { return of(id) != kAbsent; }

 private:
  static constexpr int kAbsent = -1;
  std::vector<int> by_slot_;
};

/// Adds the pose of a keyframe.
void add_pose(const Atlas& atlas, KeyFrameId id, bool fixed, PoseIndex& index,
              GatheredBundle& gathered);

void add_point(const Atlas& atlas, MapPointId id, GatheredBundle& gathered);

/// Adds every observation of the points added by one of the keyframes added.
void add_observations(const Atlas& atlas, const PoseIndex& index, GatheredBundle& gathered);

}  // namespace ydd
