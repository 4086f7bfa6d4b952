// SPDX-License-Identifier: Apache-2.0
#include "ydd/place/place_query.h"

#include <algorithm>

namespace ydd {

std::vector<PlaceCandidate> query_places(const Atlas& atlas, const BagOfWords& words,
                                         const std::function<bool(KeyFrameId)>& admit,
                                         std::size_t max_candidates) {
  std::vector<PlaceCandidate> candidates;
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (keyframe.words && admit(id)) {
      candidates.push_back({id, similarity(words, *keyframe.words)});
    }
  });
  const std::size_t n = std::min(max_candidates, candidates.size());
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(n),
                    candidates.end(), [&](const PlaceCandidate& a, const PlaceCandidate& b) {
                      if (a.score != b.score) return a.score > b.score;
                      return atlas.at(a.keyframe).serial < atlas.at(b.keyframe).serial;
                    });
  candidates.resize(n);
  return candidates;
}

}  // namespace ydd
