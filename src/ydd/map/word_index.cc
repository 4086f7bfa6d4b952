// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/word_index.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

namespace ydd {
namespace {

constexpr std::size_t kTail = 64;  // keyframes without lists
// Keyframes of a segment, numbered by 16 bits. Larger ones are looked up faster, as each word costs
// a miss of the cache in each segment, and merged in longer pauses: 30 ms every 8,000 keyframes.
constexpr std::size_t kLargest = 16384;

std::size_t words_end(const std::vector<WordIndex::Entry>& entries) {
  std::size_t end = 0;
  for (const WordIndex::Entry& e : entries) {
    if (!e.words->words.empty()) end = std::max(end, std::size_t{e.words->words.back()} + 1);
  }
  return end;
}

/// Lists of the words of these entries.
std::shared_ptr<const WordIndex::Segment> segment_of(std::vector<WordIndex::Entry> entries) {
  auto segment = std::make_shared<WordIndex::Segment>();
  segment->first.assign(words_end(entries) + 1, 0);
  for (const WordIndex::Entry& e : entries) {
    for (const std::uint16_t word : e.words->words) ++segment->first[word + 1U];
  }
  for (std::size_t w = 1; w < segment->first.size(); ++w) {
    segment->first[w] += segment->first[w - 1];
  }
  segment->postings.resize(segment->first.back());
  std::vector<std::uint32_t> next(segment->first.begin(), segment->first.end() - 1);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const BagOfWords& bag = *entries[i].words;
    for (std::size_t k = 0; k < bag.words.size(); ++k) {
      segment->postings[next[bag.words[k]]++] = {static_cast<std::uint16_t>(i),
                                                 WordIndex::whole_weight(bag.weights[k])};
    }
  }
  segment->entries = std::move(entries);
  return segment;
}

WordIndex::Part part_of(std::vector<WordIndex::Entry> entries) {
  const std::size_t kept = entries.size();
  return {segment_of(std::move(entries)), nullptr, kept};
}

void append_kept(const WordIndex::Part& part, std::vector<WordIndex::Entry>& out) {
  const auto& entries = part.segment->entries;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!part.is_gone(i)) out.push_back(entries[i]);
  }
}

/// The `wanted` heaviest words of a bag, in the order of the words; of equal ones the first.
BagOfWords heaviest(const BagOfWords& bag, std::size_t wanted) {
  // Positive floats are ordered as their bits are. One number for weight and place: no two alike.
  const auto rank = [&](std::size_t i) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(bag.weights[i])} << 32U | (UINT32_MAX - i);
  };
  std::vector<std::uint64_t> ranks(bag.words.size());
  for (std::size_t i = 0; i < ranks.size(); ++i) ranks[i] = rank(i);
  BagOfWords out;
  if (wanted == 0) return out;
  const auto last = ranks.begin() + static_cast<std::ptrdiff_t>(wanted) - 1;
  std::nth_element(ranks.begin(), last, ranks.end(), std::greater<>());
  const std::uint64_t least = *last;
  out.words.reserve(wanted);
  out.weights.reserve(wanted);
  for (std::size_t i = 0; i < bag.words.size(); ++i) {
    if (rank(i) < least) continue;
    out.words.push_back(bag.words[i]);
    out.weights.push_back(bag.weights[i]);
  }
  return out;
}

}  // namespace

std::uint16_t WordIndex::whole_weight(float weight) {
  const double scaled = std::round(static_cast<double>(weight) * kWeightScale);
  return static_cast<std::uint16_t>(std::clamp(scaled, 0.0, double{kLargestWeight}));
}

WordIndex::WordIndex(std::vector<Entry> entries) : size_(entries.size()) {
  std::sort(entries.begin(), entries.end());
  auto frequencies = std::make_shared<std::vector<std::uint32_t>>(words_end(entries), 0);
  for (const Entry& e : entries) {
    for (const std::uint16_t word : e.words->words) ++(*frequencies)[word];
  }
  frequencies_ = std::move(frequencies);
  for (std::size_t begin = 0; begin < entries.size(); begin += kLargest) {
    const auto first = entries.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto end = begin + kLargest < entries.size() ? first + kLargest : entries.end();
    parts_.push_back(part_of({first, end}));
  }
}

WordIndex WordIndex::without_bags(std::vector<Entry> entries, std::size_t most_postings) {
  std::size_t postings = 0;
  for (const Entry& e : entries) postings += e.words->words.size();
  const bool complete = postings <= most_postings;
  const std::size_t each = complete ? postings : most_postings / entries.size();
  for (Entry& e : entries) {
    if (e.words->words.size() <= each) continue;
    e.words = std::make_shared<const BagOfWords>(heaviest(*e.words, each));
  }
  WordIndex index(std::move(entries));
  index.complete_ = complete;
  for (Part& part : index.parts_) {
    auto bare = std::make_shared<Segment>(*part.segment);
    for (Entry& e : bare->entries) e.words.reset();
    part.segment = std::move(bare);
  }
  return index;
}

void WordIndex::add(Entry entry) {
  count(*entry.words, 1);
  ++size_;
  tail_.push_back(std::move(entry));
  if (tail_.size() == kTail) flush_tail();
}

void WordIndex::remove(std::int64_t serial, KeyFrameId keyframe) {
  const Entry wanted{serial, keyframe, nullptr};
  if (const auto waits = std::find(tail_.begin(), tail_.end(), wanted); waits != tail_.end()) {
    count(*waits->words, -1);
    --size_;
    tail_.erase(waits);
    return;
  }
  const auto after = std::upper_bound(
      parts_.begin(), parts_.end(), wanted,
      [](const Entry& e, const Part& part) { return e < part.segment->entries.front(); });
  if (after == parts_.begin()) throw std::logic_error("WordIndex: no such keyframe");
  const auto part = static_cast<std::size_t>(after - parts_.begin()) - 1;
  const std::vector<Entry>& entries = parts_[part].segment->entries;
  const auto found = std::lower_bound(entries.begin(), entries.end(), wanted);
  const auto entry = static_cast<std::size_t>(found - entries.begin());
  if (found == entries.end() || *found != wanted || parts_[part].is_gone(entry)) {
    throw std::logic_error("WordIndex: no such keyframe");
  }
  count(*found->words, -1);
  --size_;
  remove_from(part, entry);
}

void WordIndex::remove_from(std::size_t index, std::size_t entry) {
  Part& part = parts_[index];
  auto gone = part.gone ? std::make_shared<std::vector<bool>>(*part.gone)
                        : std::make_shared<std::vector<bool>>(part.segment->entries.size(), false);
  (*gone)[entry] = true;
  part.gone = std::move(gone);
  if (--part.kept == 0) {
    parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(index));
    return;
  }
  if (2 * part.kept > part.segment->entries.size()) return;
  if (index + 1 < parts_.size() && part.kept + parts_[index + 1].kept <= kLargest) {
    merge_with_next(index);
  } else if (index > 0 && part.kept + parts_[index - 1].kept <= kLargest) {
    merge_with_next(index - 1);
  } else {
    std::vector<Entry> entries;
    append_kept(part, entries);
    part = part_of(std::move(entries));
  }
}

void WordIndex::flush_tail() {
  parts_.push_back(part_of(std::move(tail_)));
  tail_.clear();
  // Each merge at least doubles what is behind: an entry is merged a few times in all.
  while (parts_.size() >= 2) {
    const std::size_t last = parts_[parts_.size() - 1].kept;
    const std::size_t before = parts_[parts_.size() - 2].kept;
    if (before > 2 * last || before + last > kLargest) break;
    merge_with_next(parts_.size() - 2);
  }
}

void WordIndex::merge_with_next(std::size_t index) {
  std::vector<Entry> entries;
  entries.reserve(parts_[index].kept + parts_[index + 1].kept);
  append_kept(parts_[index], entries);
  append_kept(parts_[index + 1], entries);
  parts_[index] = part_of(std::move(entries));
  parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(index) + 1);
}

void WordIndex::count(const BagOfWords& words, int change) {
  // A copy of some 40 kB: others may be reading the old one.
  auto frequencies = frequencies_ ? std::make_shared<std::vector<std::uint32_t>>(*frequencies_)
                                  : std::make_shared<std::vector<std::uint32_t>>();
  if (!words.words.empty() && words.words.back() >= frequencies->size()) {
    frequencies->resize(std::size_t{words.words.back()} + 1, 0);
  }
  for (const std::uint16_t word : words.words) {
    (*frequencies)[word] += static_cast<std::uint32_t>(change);
  }
  frequencies_ = std::move(frequencies);
}

std::vector<WordIndex::Entry> WordIndex::entries() const {
  std::vector<Entry> out;
  out.reserve(size_);
  for (const Part& part : parts_) append_kept(part, out);
  out.insert(out.end(), tail_.begin(), tail_.end());
  return out;
}

}  // namespace ydd
