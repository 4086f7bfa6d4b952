// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "ydd/features/vocabulary.h"
#include "ydd/map/atlas.h"

namespace ydd {

/// A keyframe that may show the same place.
struct PlaceCandidate {
  KeyFrameId keyframe;
  double score = 0;  ///< similarity of the bags of words, [0, 1]
};

/// The `max_candidates` keyframes most similar to `words` among those that `admit` lets through,
/// best first, ties to the older. Compares with every keyframe of the snapshot: there is no index
/// beside the map that culling or a second thread could leave behind. 0.4 ms at 1,000 keyframes,
/// 14 ms at 10,000 (bench/place_bench.cc).
std::vector<PlaceCandidate> query_places(const Atlas& atlas, const BagOfWords& words,
                                         const std::function<bool(KeyFrameId)>& admit,
                                         std::size_t max_candidates);

/// The candidates that stand for places of their own: one that is covisible with a better one, or
/// has a covisible keyframe in common with it, says nothing new and goes. At most `max_places`.
std::vector<PlaceCandidate> distinct_places(const Atlas& atlas,
                                            const std::vector<PlaceCandidate>& candidates,
                                            std::size_t max_places);

}  // namespace ydd
