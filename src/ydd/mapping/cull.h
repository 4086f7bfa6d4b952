// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ydd/map/atlas.h"
#include "ydd/matching/keyframe_candidate.h"

namespace ydd {

/// Which points and keyframes go; describe() has the sentences.
struct CullOptions {
  double min_found_ratio = 0.25;
  int probation_keyframes = 2;
  int contradicted_frames = 15;
  int min_observations = 2;
  double redundant_share = 0.9;
  int redundant_observations = 3;
  double close_depth_m = 3.0;  ///< SystemOptions sets it
  void describe(OptionTable& table);
};

/// Removes points on probation that tracking rarely finds or that too few keyframes saw; takes
/// those off the list that passed. Gives how many went.
int cull_recent_points(Atlas& atlas, std::vector<MapPointId>& recent, KeyFrameId newest,
                       const CullOptions& options);

/// Removes points that stand where the camera has looked through, or on what moves, for so many
/// frames in which they should have been seen (tracking counts them in variant `evidence`). Gives
/// how many went.
int cull_contradicted_points(Atlas& atlas, std::span<const PointViews> views,
                             const CullOptions& options);

/// Removes keyframes around `newest` most of whose near points at least three others see at the
/// same or a finer scale. Gives how many went.
int cull_redundant_keyframes(Atlas& atlas, KeyFrameId newest, const CullOptions& options);

}  // namespace ydd
