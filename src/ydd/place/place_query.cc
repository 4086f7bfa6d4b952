// SPDX-License-Identifier: Apache-2.0
#include "ydd/place/place_query.h"

#include <algorithm>
#include <set>

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

std::vector<PlaceCandidate> distinct_places(const Atlas& atlas,
                                            const std::vector<PlaceCandidate>& candidates,
                                            std::size_t max_places) {
  std::vector<PlaceCandidate> places;
  std::set<KeyFrameId> taken;
  for (const PlaceCandidate& candidate : candidates) {
    if (places.size() == max_places) break;
    std::vector<KeyFrameId> around{candidate.keyframe};
    for (const Covisible& c : atlas.at(candidate.keyframe).covisible) around.push_back(c.keyframe);
    const bool known = std::any_of(around.begin(), around.end(),
                                   [&](KeyFrameId id) { return taken.contains(id); });
    if (known) continue;
    taken.insert(around.begin(), around.end());
    places.push_back(candidate);
  }
  return places;
}

}  // namespace ydd
