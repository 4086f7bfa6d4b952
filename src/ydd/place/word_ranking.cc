// SPDX-License-Identifier: Apache-2.0
#include "ydd/place/word_ranking.h"

#include <algorithm>

namespace ydd {
namespace {

// Classes of size: a sum of weights is hardly more than kWeightScale = 2^18.
constexpr std::uint32_t kClassShift = 8;
constexpr std::size_t kClasses = 2048;
constexpr std::size_t kFirstBatch = 256;

std::size_t size_class(std::uint32_t common) {
  return std::min<std::size_t>(common >> kClassShift, kClasses - 1);
}

/// Adds to `common`, by entry of the segment, what the lists of the words say.
void add_common(const WordIndex::Segment& segment, const WordLookup& lookup,
                std::uint32_t* common) {
  // Lists lie far from each other: what is asked for a few words ahead is there in time.
  constexpr std::size_t kAhead = 8;
  for (std::size_t i = 0; i < lookup.words.size(); ++i) {
    if (i + kAhead < lookup.words.size()) {
      const auto ahead = segment.of_word(lookup.words[i + kAhead].word);
      for (std::size_t k = 0; k < ahead.size() && k < 64; k += 16) __builtin_prefetch(&ahead[k]);
    }
    const WordLookup::Word& w = lookup.words[i];
    for (const WordIndex::Posting& posting : segment.of_word(w.word)) {
      common[posting.entry] += std::min(posting.weight, w.weight);
    }
  }
}

/// The same of the keyframes that wait for a segment.
void add_common(const std::vector<WordIndex::Entry>& tail, const WordLookup& lookup,
                std::uint32_t* common) {
  std::vector<std::uint16_t> weights;
  for (const WordLookup::Word& w : lookup.words) {
    if (w.word >= weights.size()) weights.resize(std::size_t{w.word} + 1, 0);
    weights[w.word] = w.weight;
  }
  for (std::size_t i = 0; i < tail.size(); ++i) {
    const BagOfWords& bag = *tail[i].words;
    for (std::size_t k = 0; k < bag.words.size() && bag.words[k] < weights.size(); ++k) {
      if (weights[bag.words[k]] == 0) continue;
      common[i] += std::min(WordIndex::whole_weight(bag.weights[k]), weights[bag.words[k]]);
    }
  }
}

}  // namespace

WordLookup choose_words(const WordIndex& index, const BagOfWords& bag, std::size_t most_postings) {
  struct Choice {
    double worth = 0;  // weight for an entry
    std::size_t i = 0;
  };
  std::vector<Choice> choices;
  choices.reserve(bag.words.size());
  for (std::size_t i = 0; i < bag.words.size(); ++i) {
    const std::uint32_t frequency = index.frequency(bag.words[i]);
    if (frequency > 0) choices.push_back({static_cast<double>(bag.weights[i]) / frequency, i});
  }
  std::sort(choices.begin(), choices.end(), [](const Choice& a, const Choice& b) {
    return a.worth != b.worth ? a.worth > b.worth : a.i < b.i;
  });
  constexpr double kRounding = 0.5 / WordIndex::kWeightScale;
  constexpr double kLargest = WordIndex::kLargestWeight / WordIndex::kWeightScale;
  WordLookup lookup;
  std::size_t postings = 0;
  for (const Choice& choice : choices) {
    const float weight = bag.weights[choice.i];
    postings += index.frequency(bag.words[choice.i]);
    if (postings > most_postings) {
      lookup.all = false;
      lookup.unseen += static_cast<double>(weight);
    } else {
      lookup.unseen += kRounding + std::max(0.0, static_cast<double>(weight) - kLargest);
      lookup.words.push_back({bag.words[choice.i], WordIndex::whole_weight(weight)});
    }
  }
  // Sums do not depend on the order; the memory is read from front to back.
  std::sort(lookup.words.begin(), lookup.words.end(),
            [](const auto& a, const auto& b) { return a.word < b.word; });
  return lookup;
}

WordRanking::WordRanking(const WordIndex& index, const WordLookup& lookup)
    : index_(&index), counts_(kClasses, 0), sorted_down_to_(kClasses), batch_(kFirstBatch) {
  std::size_t entries = 0;
  for (const WordIndex::Part& part : index.parts()) {
    begins_.push_back(entries);
    entries += part.segment->entries.size();
  }
  begins_.push_back(entries);
  common_.assign(entries + index.tail().size(), 0);
  for (std::size_t p = 0; p < index.parts().size(); ++p) {
    add_common(*index.parts()[p].segment, lookup, common_.data() + begins_[p]);
  }
  add_common(index.tail(), lookup, common_.data() + entries);
  for (const std::uint32_t common : common_) ++counts_[size_class(common)];
}

void WordRanking::sort_more() {
  const std::size_t end = sorted_down_to_;
  for (std::size_t more = 0; sorted_down_to_ > 0 && more < batch_;) {
    more += counts_[--sorted_down_to_];
  }
  batch_ *= 4;  // who asks once more may want them all
  sorted_.clear();
  at_ = 0;
  for (std::size_t i = 0; i < common_.size(); ++i) {
    const std::size_t c = size_class(common_[i]);
    if (c < sorted_down_to_ || c >= end || common_[i] == 0) continue;
    sorted_.push_back({common_[i], static_cast<std::uint32_t>(i)});
  }
  std::sort(sorted_.begin(), sorted_.end(), [](const Numbered& a, const Numbered& b) {
    return a.common != b.common ? a.common > b.common : a.number < b.number;
  });
}

std::optional<PromisingKeyframe> WordRanking::next() {
  for (;;) {
    while (at_ == sorted_.size()) {
      if (sorted_down_to_ == 0) return std::nullopt;
      sort_more();
    }
    const Numbered& numbered = sorted_[at_++];
    const auto after = std::upper_bound(begins_.begin(), begins_.end(), numbered.number);
    const auto p = static_cast<std::size_t>(after - begins_.begin()) - 1;
    const std::size_t i = numbered.number - begins_[p];
    const bool waits = p == index_->parts().size();
    if (!waits && index_->parts()[p].is_gone(i)) continue;
    const WordIndex::Entry& entry =
        waits ? index_->tail()[i] : index_->parts()[p].segment->entries[i];
    return PromisingKeyframe{&entry, numbered.common / WordIndex::kWeightScale};
  }
}

}  // namespace ydd
