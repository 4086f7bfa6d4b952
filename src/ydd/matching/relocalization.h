// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "ydd/matching/projection_search.h"
#include "ydd/optimization/pose_only.h"

namespace ydd {

/// When a lost camera counts as found; describe() has the sentences.
struct RelocalizationOptions {
  double match_ratio = 0.75;
  int min_matches = 15;
  int ransac_iterations = 200;
  double ransac_threshold_px = 4.0;
  int min_inliers = 30;
  double rival_share = 0.7;
  int seed = 1;
  void describe(OptionTable& table);
};

/// A pose found without knowing where the camera was before.
struct Relocalization {
  SE3 T_camera_world;
  std::vector<PointMatch> inliers;
  KeyFrameId keyframe;  ///< the one that was recognised
};

/// Tries each candidate keyframe in turn: descriptor matches, PnP inside RANSAC (OpenCV), pose
/// optimisation, then a guided search of the keyframe's neighbourhood. The first that reaches
/// `min_inliers` is taken. Deterministic for a given seed.
std::optional<Relocalization> relocalize(const Atlas& atlas, const TrackedFrame& frame,
                                         std::span<const KeyFrameId> candidates,
                                         const RelocalizationOptions& options,
                                         const PoseOnlyOptions& pose_options,
                                         const MatchLimits& limits);

/// Like `relocalize`, but nothing if the picture fits two places: each of `places` stands for one,
/// and none may reach `rival_share` of the points of the best.
std::optional<Relocalization> relocalize_uniquely(const Atlas& atlas, const TrackedFrame& frame,
                                                  std::span<const KeyFrameId> places,
                                                  const RelocalizationOptions& options,
                                                  const PoseOnlyOptions& pose_options,
                                                  const MatchLimits& limits);

}  // namespace ydd
