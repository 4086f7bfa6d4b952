// SPDX-License-Identifier: Apache-2.0
#include "ydd/place/place_query.h"

#include <algorithm>
#include <array>
#include <set>

namespace ydd {
namespace {

/// The weights of one bag by word, to compare many others with. What two bags have in common is
/// the sum of the smaller weights: 1 - |a - b|_1 / 2, as both sum to 1.
class SpreadOut {
 public:
  explicit SpreadOut(const BagOfWords& bag) {
    if (bag.words.empty()) return;
    weights_.assign(std::size_t{bag.words.back()} + 1, 0.0F);
    for (std::size_t i = 0; i < bag.words.size(); ++i) weights_[bag.words[i]] = bag.weights[i];
  }

  double similarity(const BagOfWords& other) const {
    const auto end = std::upper_bound(other.words.begin(), other.words.end(),
                                      weights_.empty() ? 0 : weights_.size() - 1) -
                     other.words.begin();
    // Four sums: an addition need not wait for the one before.
    std::array<float, 4> sums{};
    const auto n = static_cast<std::size_t>(weights_.empty() ? 0 : end);
    std::size_t i = 0;
    for (; i + 4 <= n; i += 4) {
      for (std::size_t k = 0; k < 4; ++k) {
        sums[k] += std::min(weights_[other.words[i + k]], other.weights[i + k]);
      }
    }
    for (; i < n; ++i) sums[0] += std::min(weights_[other.words[i]], other.weights[i]);
    return static_cast<double>((sums[0] + sums[1]) + (sums[2] + sums[3]));
  }

 private:
  std::vector<float> weights_;
};

}  // namespace

std::vector<PlaceCandidate> query_places(const Atlas& atlas, const BagOfWords& words,
                                         const std::function<bool(KeyFrameId)>& admit,
                                         std::size_t max_candidates) {
  const SpreadOut query(words);
  std::vector<PlaceCandidate> candidates;
  candidates.reserve(atlas.keyframes().size());
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (keyframe.words && admit(id)) {
      candidates.push_back({id, query.similarity(*keyframe.words)});
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
