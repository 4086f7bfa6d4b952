// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <vector>

#include "ydd/map/atlas.h"
#include "ydd/optimization/bundle_adjustment.h"

namespace ydd {

struct LocalBundleOptions {
  BundleOptions solver;
  int max_free_keyframes = 30;
  int max_fixed_keyframes = 60;
  void describe(OptionTable& table);
};

/// A bundle problem and which keyframe, point and sighting each of its parts is.
struct GatheredBundle {
  BundleProblem problem;
  std::vector<KeyFrameId> keyframes;  ///< parallel to problem.poses
  std::vector<MapPointId> points;     ///< parallel to problem.points
};

/// The keyframe and those that share most points with it are free, all points they see are free,
/// other keyframes that see these points hold the frame of reference.
GatheredBundle gather_local_bundle(const Atlas& atlas, KeyFrameId keyframe,
                                   const LocalBundleOptions& options);

/// Writes solved poses and points into the atlas and unlinks observations judged outliers.
void apply_bundle(Atlas& atlas, const GatheredBundle& gathered, const BundleResult& result);

}  // namespace ydd
