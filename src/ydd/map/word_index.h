// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ydd/base/id.h"
#include "ydd/features/vocabulary.h"

namespace ydd {

/// Which keyframes show which visual words: an inverted index with cheap immutable copies.
///
/// Keyframes lie in segments by the order of creation. A segment never changes: the newest
/// keyframes wait in a tail without lists, a full tail becomes a segment, small neighbours are
/// merged, one that has lost half of its keyframes is made anew (O'Neil et al., "The log-structured
/// merge-tree", Acta Informatica 1996). So a copy costs a pointer for each few thousand keyframes,
/// and adding one some ten microseconds in the mean, whatever the size of the map.
///
/// What it holds is part of the atlas, whose edits keep it; place_query.h asks it.
/// Thread: as the atlas: one owner edits, copies may be read from any thread.
class WordIndex {
 public:
  /// A keyframe of the index.
  struct Entry {
    std::int64_t serial = 0;  ///< of the keyframe
    KeyFrameId keyframe;
    std::shared_ptr<const BagOfWords> words;
    friend auto operator<=>(const Entry& a, const Entry& b) {
      if (const auto order = a.serial <=> b.serial; order != 0) return order;
      return a.keyframe <=> b.keyframe;
    }
    friend bool operator==(const Entry& a, const Entry& b) { return (a <=> b) == 0; }
  };

  /// Weights in lists are whole numbers, so that sums do not depend on their order; larger ones
  /// than `kLargestWeight` are cut to it.
  static constexpr double kWeightScale = 1 << 18;
  static constexpr std::uint16_t kLargestWeight = 0xFFFF;
  static std::uint16_t whole_weight(float weight);

  /// That a keyframe shows a word.
  struct Posting {
    std::uint16_t entry = 0;   ///< of the segment
    std::uint16_t weight = 0;  ///< whole_weight
  };

  /// Keyframes with the postings of their words; never changed.
  struct Segment {
    std::vector<Entry> entries;  ///< in the order of creation; never empty
    std::vector<Posting> postings;
    std::vector<std::uint32_t> first;  ///< posting of each word, and their end

    std::span<const Posting> of_word(std::uint16_t word) const {
      if (std::size_t{word} + 1 >= first.size()) return {};
      return std::span(postings).subspan(first[word], first[word + 1U] - first[word]);
    }
  };

  /// A segment, and which of its entries have gone since.
  struct Part {
    std::shared_ptr<const Segment> segment;
    std::shared_ptr<const std::vector<bool>> gone;  ///< by entry; null: none is
    std::size_t kept = 0;                           ///< entries that are not gone

    bool is_gone(std::size_t entry) const { return gone && (*gone)[entry]; }
  };

  WordIndex() = default;
  /// Of all these at once.
  explicit WordIndex(std::vector<Entry> entries);

  /// Of all these at once, to be asked and not edited: it holds no bags (entries have none), and
  /// where there are more than `most_postings` words in all, each keyframe is listed under an equal
  /// number of those that tell most of it.
  static WordIndex without_bags(std::vector<Entry> entries, std::size_t most_postings);
  /// Whether every keyframe is listed under all of its words.
  bool complete() const { return complete_; }

  /// Adds a keyframe that is newer than all others.
  void add(Entry entry);
  /// @throws std::logic_error if it is not there.
  void remove(std::int64_t serial, KeyFrameId keyframe);

  std::size_t size() const { return size_; }
  const std::vector<Part>& parts() const { return parts_; }
  /// The newest keyframes, which are in no segment yet.
  const std::vector<Entry>& tail() const { return tail_; }
  /// In how many of the keyframes in segments or tail a word is.
  std::uint32_t frequency(std::uint16_t word) const {
    return frequencies_ && word < frequencies_->size() ? (*frequencies_)[word] : 0;
  }
  /// All entries in the order of creation.
  std::vector<Entry> entries() const;

 private:
  void count(const BagOfWords& words, int change);
  void flush_tail();
  void remove_from(std::size_t part, std::size_t entry);
  void merge_with_next(std::size_t part);

  std::vector<Part> parts_;
  std::vector<Entry> tail_;
  std::shared_ptr<const std::vector<std::uint32_t>> frequencies_;  ///< by word
  std::size_t size_ = 0;
  bool complete_ = true;
};

}  // namespace ydd
