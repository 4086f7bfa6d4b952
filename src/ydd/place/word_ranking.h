// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "ydd/map/word_index.h"

/// How a place query asks the index of words. Inside the room only.
namespace ydd {

/// The words of a query that are looked up.
struct WordLookup {
  /// A word that is looked up.
  struct Word {
    std::uint16_t word = 0;
    std::uint16_t weight = 0;  ///< WordIndex::whole_weight
  };
  std::vector<Word> words;
  bool all = true;  ///< that any keyframe shows
  /// How much more similar than by these words a keyframe can be: the weight of the others, and
  /// what rounding takes away.
  double unseen = 0;
};

/// Those of a bag that tell most, weight for entries of the index, until `most_postings` entries
/// are used up.
WordLookup choose_words(const WordIndex& index, const BagOfWords& bag, std::size_t most_postings);

/// A keyframe that shares words with the one asked about.
struct PromisingKeyframe {
  const WordIndex::Entry* entry = nullptr;  ///< of the index
  double common = 0;                        ///< similarity by the words looked up
};

/// The keyframes of an index by what they have in common with a query, most first,
/// ties to the older; without those that have nothing. Sorted no further than somebody asks. The
/// index must outlive it.
class WordRanking {
 public:
  WordRanking(const WordIndex& index, const WordLookup& lookup);

  /// The next one; nothing after the last.
  std::optional<PromisingKeyframe> next();

 private:
  struct Numbered {
    std::uint32_t common = 0;
    std::uint32_t number = 0;
  };
  void sort_more();

  const WordIndex* index_;
  std::vector<std::size_t> begins_;    ///< number of the first entry of each part, and of the tail
  std::vector<std::uint32_t> common_;  ///< by number, in units of WordIndex::kWeightScale
  std::vector<std::uint32_t> counts_;  ///< keyframes by size of what is common
  std::size_t sorted_down_to_;         ///< class of size
  std::size_t batch_;
  std::vector<Numbered> sorted_;
  std::size_t at_ = 0;
};

}  // namespace ydd
