// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>

#include "ydd/base/result.h"
#include "ydd/map/atlas.h"

namespace ydd {

/// The atlas with these maps alone: ids, serials and map numbers stay, what belongs to other maps
/// goes, loops to it and keyframes that were culled from it included. Failure: none of them is in
/// the atlas.
Result<Atlas> keep_maps(const Atlas& atlas, const std::set<MapId>& maps);

/// What is not worth keeping in a map that is used again.
struct PruneOptions {
  int min_keyframes = 3;     ///< a map with fewer goes as a whole
  int min_observations = 2;  ///< a point that fewer keyframes see was never seen again
  int min_points = 15;       ///< a keyframe that then sees fewer holds nothing together
};

/// What is left, and how much went.
struct PrunedMap {
  Atlas atlas;                                      ///< with what is left
  std::size_t maps = 0, keyframes = 0, points = 0;  ///< that went
};

/// Takes out what was never seen again. The largest map and the first keyframe of every map that
/// stays are kept. Failure: the atlas holds no keyframe.
Result<PrunedMap> prune_atlas(const Atlas& atlas, const PruneOptions& options);

}  // namespace ydd
