// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "ydd/features/vocabulary.h"
#include "ydd/map/atlas.h"

namespace ydd {

/// A keyframe that may show the same place.
struct PlaceCandidate {
  KeyFrameId keyframe;
  double score = 0;  ///< similarity of the bags of words, [0, 1]
};

/// How far a query goes.
struct PlaceQueryLimits {
  /// Entries of the index that are looked at. What a picture of 700 words has in common with
  /// some 8,000 others; beyond that its commonest words tell little.
  std::size_t most_postings = 400'000;
  /// Keyframes that are compared word by word, when not all words could be looked at.
  std::size_t most_compared = 128;
};

/// The `max_candidates` keyframes most similar to `words` among those that `admit` lets through,
/// best first, ties to the older; those without a word in common are none. `admit` is asked about
/// the most promising keyframes only, in no order that means anything.
///
/// Asks the index of the atlas: words are looked up, those first that tell most for the entries
/// that they cost, and the keyframes with most in common are compared word by word. While all
/// words are looked up the answer is that of comparing with every keyframe. In a map so large that
/// they are not, a keyframe may be missing that shares nothing but common words with the query:
/// time is bound by the limits and not by the size of the map. Deterministic, and independent of
/// the order of edits that led to the map.
std::vector<PlaceCandidate> query_places(const Atlas& atlas, const BagOfWords& words,
                                         const std::function<bool(KeyFrameId)>& admit,
                                         std::size_t max_candidates,
                                         const PlaceQueryLimits& limits = {});

/// Gives the words of a keyframe of the index.
using BagSource = std::function<std::shared_ptr<const BagOfWords>(const WordIndex::Entry&)>;

/// The same of an index whose words may lie elsewhere: `bag_of` is asked for those that are
/// compared. In an index that is not complete a keyframe may be missing that shares none of its
/// most telling words with the query.
std::vector<PlaceCandidate> query_index(const WordIndex& index, const BagOfWords& words,
                                        const std::function<bool(KeyFrameId)>& admit,
                                        const BagSource& bag_of, std::size_t max_candidates,
                                        const PlaceQueryLimits& limits = {});

/// The same by comparing with every keyframe: what `query_places` is held against.
std::vector<PlaceCandidate> query_places_exhaustively(const Atlas& atlas, const BagOfWords& words,
                                                      const std::function<bool(KeyFrameId)>& admit,
                                                      std::size_t max_candidates);

/// The candidates that stand for places of their own: one that is covisible with a better one, or
/// has a covisible keyframe in common with it, says nothing new and goes. At most `max_places`.
std::vector<PlaceCandidate> distinct_places(const Atlas& atlas,
                                            const std::vector<PlaceCandidate>& candidates,
                                            std::size_t max_places);

/// The same, where `neighbours_of` tells with whom a keyframe is covisible.
std::vector<PlaceCandidate> distinct_places(
    const std::vector<PlaceCandidate>& candidates, std::size_t max_places,
    const std::function<std::vector<Covisible>(KeyFrameId)>& neighbours_of);

}  // namespace ydd
