// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/word_index.h"

#include <algorithm>
#include <map>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace ydd {
namespace {

using Entry = WordIndex::Entry;

std::shared_ptr<const BagOfWords> random_bag(std::mt19937& random, int vocabulary, int words) {
  std::map<std::uint16_t, float> weights;
  for (int i = 0; i < words; ++i) {
    weights[static_cast<std::uint16_t>(random() % static_cast<unsigned>(vocabulary))] += 1.0F;
  }
  auto bag = std::make_shared<BagOfWords>();
  for (const auto& [word, weight] : weights) {
    bag->words.push_back(word);
    bag->weights.push_back(weight / static_cast<float>(words));
  }
  return bag;
}

Entry entry(std::int64_t serial, std::shared_ptr<const BagOfWords> words) {
  return {serial,
          {static_cast<std::uint32_t>(serial % 97), 1 + static_cast<std::uint32_t>(serial)},
          std::move(words)};
}

/// What the index tells, by word: serials and weights of the keyframes that show it.
std::map<std::uint16_t, std::map<std::int64_t, std::uint16_t>> content(const WordIndex& index) {
  std::map<std::uint16_t, std::map<std::int64_t, std::uint16_t>> out;
  for (const WordIndex::Part& part : index.parts()) {
    for (std::uint32_t word = 0; word <= UINT16_MAX; ++word) {
      for (const auto& posting : part.segment->of_word(static_cast<std::uint16_t>(word))) {
        if (part.is_gone(posting.entry)) continue;
        out[static_cast<std::uint16_t>(word)][part.segment->entries[posting.entry].serial] =
            posting.weight;
      }
    }
  }
  for (const Entry& e : index.tail()) {
    for (std::size_t i = 0; i < e.words->words.size(); ++i) {
      out[e.words->words[i]][e.serial] = WordIndex::whole_weight(e.words->weights[i]);
    }
  }
  return out;
}

/// Whether the index holds exactly these, in order, with the right lists and frequencies.
void expect_holds(const WordIndex& index, const std::map<std::int64_t, Entry>& kept) {
  ASSERT_EQ(index.size(), kept.size());
  std::vector<Entry> expected;
  std::map<std::uint16_t, std::map<std::int64_t, std::uint16_t>> lists;
  for (const auto& [serial, e] : kept) {
    expected.push_back(e);
    for (std::size_t i = 0; i < e.words->words.size(); ++i) {
      lists[e.words->words[i]][serial] = WordIndex::whole_weight(e.words->weights[i]);
    }
  }
  EXPECT_EQ(index.entries(), expected);
  EXPECT_EQ(content(index), lists);
  for (const auto& [word, list] : lists) EXPECT_EQ(index.frequency(word), list.size());
  std::size_t in_segments = 0;
  for (const WordIndex::Part& part : index.parts()) {
    EXPECT_GT(part.kept, 0U);
    EXPECT_GT(2 * part.kept, part.segment->entries.size()) << "most of a segment is gone";
    in_segments += part.kept;
  }
  EXPECT_EQ(in_segments + index.tail().size(), kept.size());
}

TEST(WordIndex, HoldsWhatWasAddedAndNotRemovedWhateverTheOrder) {
  std::mt19937 random(1);
  WordIndex index;
  std::map<std::int64_t, Entry> kept;
  for (std::int64_t serial = 0; serial < 1500; ++serial) {
    kept[serial] = entry(serial, random_bag(random, 300, 12));
    index.add(kept[serial]);
    // Most go again, soon as a rule and sometimes late.
    for (int i = 0; i < 2 && kept.size() > 1 && random() % 5 < 2; ++i) {
      const auto newest = std::prev(kept.end());
      auto goes = random() % 3 == 0 ? std::next(kept.begin(), random() % kept.size()) : newest;
      index.remove(goes->first, goes->second.keyframe);
      kept.erase(goes);
    }
    if (serial % 300 == 299) expect_holds(index, kept);
  }
  while (!kept.empty()) {
    const auto goes = std::next(kept.begin(), random() % kept.size());
    index.remove(goes->first, goes->second.keyframe);
    kept.erase(goes);
    if (kept.size() % 200 == 0) expect_holds(index, kept);
  }
}

TEST(WordIndex, MadeAtOnceItHoldsTheSame) {
  std::mt19937 random(2);
  std::map<std::int64_t, Entry> kept;
  std::vector<Entry> entries;
  for (std::int64_t serial = 0; serial < 20000; ++serial) {
    kept[serial] = entry(serial, random_bag(random, 200, 3));
    entries.push_back(kept[serial]);
  }
  std::shuffle(entries.begin(), entries.end(), random);
  WordIndex index(entries);
  EXPECT_GT(index.parts().size(), 1U);
  expect_holds(index, kept);
  kept[20000] = entry(20000, random_bag(random, 400, 5));  // words that were not there yet
  index.add(kept[20000]);
  index.remove(17, kept[17].keyframe);
  kept.erase(17);
  expect_holds(index, kept);
}

TEST(WordIndex, ACopyStaysAsItWas) {
  std::mt19937 random(3);
  WordIndex index;
  std::map<std::int64_t, Entry> kept;
  for (std::int64_t serial = 0; serial < 200; ++serial) {
    kept[serial] = entry(serial, random_bag(random, 100, 8));
    index.add(kept[serial]);
  }
  const WordIndex copy = index;
  for (std::int64_t serial = 0; serial < 200; serial += 2) {
    index.remove(serial, kept[serial].keyframe);
  }
  for (std::int64_t serial = 200; serial < 300; ++serial) {
    index.add(entry(serial, random_bag(random, 100, 8)));
  }
  EXPECT_EQ(index.size(), 200U);
  expect_holds(copy, kept);
}

TEST(WordIndex, SegmentsStayFew) {
  std::mt19937 random(4);
  WordIndex index;
  for (std::int64_t serial = 0; serial < 20000; ++serial) {
    index.add(entry(serial, random_bag(random, 50, 2)));
    ASSERT_LE(index.parts().size(), 6U + static_cast<std::size_t>(serial) / 1000U);
  }
}

TEST(WordIndex, WhatIsNotThereCannotBeRemoved) {
  std::mt19937 random(5);
  WordIndex index;
  EXPECT_THROW(index.remove(0, {0, 1}), std::logic_error);
  std::vector<Entry> entries;
  for (std::int64_t serial = 10; serial < 100; ++serial) {
    entries.push_back(entry(serial, random_bag(random, 50, 4)));
    index.add(entries.back());
  }
  EXPECT_THROW(index.remove(9, {9, 10}), std::logic_error);
  EXPECT_THROW(index.remove(entries[3].serial, entries[4].keyframe), std::logic_error);
  index.remove(entries[3].serial, entries[3].keyframe);
  EXPECT_THROW(index.remove(entries[3].serial, entries[3].keyframe), std::logic_error);
  EXPECT_EQ(index.size(), 89U);
}

TEST(WordIndex, WeightsAreWholeNumbersThatDoNotOverflow) {
  EXPECT_EQ(WordIndex::whole_weight(0.0F), 0);
  EXPECT_EQ(WordIndex::whole_weight(0.125F), 1 << 15);
  EXPECT_EQ(WordIndex::whole_weight(1.0F), WordIndex::kLargestWeight);
}

}  // namespace
}  // namespace ydd
