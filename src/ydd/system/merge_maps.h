// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/base/result.h"
#include "ydd/loop/loop_closer.h"
#include "ydd/mapping/mapper.h"

namespace ydd {

/// Where a map of the second atlas was merged into one of the first.
struct MapMerge {
  MapId map;                    ///< of the joined atlas: the one that moved
  MapId into;                   ///< the one that it became part of
  std::size_t points = 0;       ///< that agree
  std::size_t keyframes = 0;    ///< of the map that moved
  std::size_t overlapping = 0;  ///< of these: within 1 m and 30 degrees of one that was there
};

/// Both atlases in one.
struct MergedMaps {
  Atlas atlas;
  std::vector<MapMerge> merges;
  int separate = 0;  ///< maps of the second atlas in which no common place was found
};

/// Puts the maps of `b` beside those of `a`, then merges each into one of `a` where place
/// recognition finds a common place and all checks of loop closing hold: the map of `b` moves, that
/// of `a` stays. Ends with bundle adjustment over the merged map if that is switched on.
/// Deterministic. Failure: cameras or pyramids differ.
Result<MergedMaps> merge_maps(const Atlas& a, const Atlas& b, const MapperOptions& mapping,
                              const LoopOptions& loop);

}  // namespace ydd
