// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/map/atlas.h"

namespace ydd {

struct CullOptions {
  double min_found_ratio = 0.25;
  int probation_keyframes = 2;
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

/// Removes keyframes around `newest` most of whose near points at least three others see at the
/// same or a finer scale. Gives how many went.
int cull_redundant_keyframes(Atlas& atlas, KeyFrameId newest, const CullOptions& options);

}  // namespace ydd
