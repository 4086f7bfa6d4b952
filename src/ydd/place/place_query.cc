// SPDX-License-Identifier: Apache-2.0
#include "ydd/place/place_query.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <utility>

#include "ydd/place/word_ranking.h"

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

struct Compared {
  double score = 0;
  std::int64_t serial = 0;
  KeyFrameId keyframe;
};

/// Better first.
bool is_better(const Compared& a, const Compared& b) {
  if (a.score != b.score) return a.score > b.score;
  return a.serial < b.serial;
}

/// The best few of what has been compared so far.
class Best {
 public:
  explicit Best(std::size_t wanted) : wanted_(wanted) {}

  void add(const Compared& compared) {
    if (compared.score <= 0 || wanted_ == 0) return;
    if (heap_.size() == wanted_) {
      if (!is_better(compared, heap_.front())) return;
      std::pop_heap(heap_.begin(), heap_.end(), is_better);
      heap_.pop_back();
    }
    heap_.push_back(compared);
    std::push_heap(heap_.begin(), heap_.end(), is_better);
  }
  /// What a keyframe must be better than, or as good as, to change anything.
  double needed() const { return heap_.size() < wanted_ ? 0.0 : heap_.front().score; }

  std::vector<PlaceCandidate> take() && {
    std::sort(heap_.begin(), heap_.end(), is_better);
    std::vector<PlaceCandidate> out;
    out.reserve(heap_.size());
    for (const Compared& c : heap_) out.push_back({c.keyframe, c.score});
    return out;
  }

 private:
  std::size_t wanted_;
  std::vector<Compared> heap_;  ///< the worst in front
};

/// How many are compared although not all words were looked up: some for each that is wanted.
std::size_t enough_compared(std::size_t wanted, const PlaceQueryLimits& limits) {
  return std::max(4 * wanted, limits.most_compared);
}

}  // namespace

std::vector<PlaceCandidate> query_index(const WordIndex& index, const BagOfWords& words,
                                        const std::function<bool(KeyFrameId)>& admit,
                                        const BagSource& bag_of, std::size_t max_candidates,
                                        const PlaceQueryLimits& limits) {
  const SpreadOut query(words);
  Best best(max_candidates);
  std::size_t compared = 0;
  const auto compare = [&](const WordIndex::Entry& entry) {
    if (!admit(entry.keyframe)) return;
    best.add({query.similarity(*bag_of(entry)), entry.serial, entry.keyframe});
    ++compared;
  };
  const WordLookup lookup = choose_words(index, words, limits.most_postings);
  const bool all = lookup.all && index.complete();
  WordRanking ranking(index, lookup);
  while (const std::optional<PromisingKeyframe> next = ranking.next()) {
    if (index.complete() && next->common + lookup.unseen < best.needed()) break;
    if (!all && compared >= enough_compared(max_candidates, limits)) break;
    compare(*next->entry);
  }
  return std::move(best).take();
}

std::vector<PlaceCandidate> query_places(const Atlas& atlas, const BagOfWords& words,
                                         const std::function<bool(KeyFrameId)>& admit,
                                         std::size_t max_candidates,
                                         const PlaceQueryLimits& limits) {
  return query_index(
      atlas.word_index(), words, admit, [](const WordIndex::Entry& entry) { return entry.words; },
      max_candidates, limits);
}

std::vector<PlaceCandidate> query_places_exhaustively(const Atlas& atlas, const BagOfWords& words,
                                                      const std::function<bool(KeyFrameId)>& admit,
                                                      std::size_t max_candidates) {
  const SpreadOut query(words);
  Best best(max_candidates);
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (!keyframe.words || !admit(id)) return;
    best.add({query.similarity(*keyframe.words), keyframe.serial, id});
  });
  return std::move(best).take();
}

std::vector<PlaceCandidate> distinct_places(
    const std::vector<PlaceCandidate>& candidates, std::size_t max_places,
    const std::function<std::vector<Covisible>(KeyFrameId)>& neighbours_of) {
  std::vector<PlaceCandidate> places;
  std::set<KeyFrameId> taken;
  for (const PlaceCandidate& candidate : candidates) {
    if (places.size() == max_places) break;
    std::vector<KeyFrameId> around{candidate.keyframe};
    for (const Covisible& c : neighbours_of(candidate.keyframe)) around.push_back(c.keyframe);
    const bool known = std::any_of(around.begin(), around.end(),
                                   [&](KeyFrameId id) { return taken.contains(id); });
    if (known) continue;
    taken.insert(around.begin(), around.end());
    places.push_back(candidate);
  }
  return places;
}

std::vector<PlaceCandidate> distinct_places(const Atlas& atlas,
                                            const std::vector<PlaceCandidate>& candidates,
                                            std::size_t max_places) {
  return distinct_places(candidates, max_places,
                         [&](KeyFrameId id) { return atlas.at(id).covisible; });
}

}  // namespace ydd
