// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/vocabulary.h"

#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace ydd {
namespace {

std::vector<Descriptor> random_descriptors(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<Descriptor> out(static_cast<std::size_t>(count));
  for (Descriptor& d : out) {
    for (std::uint64_t& part : d) part = random();
  }
  return out;
}

TEST(Vocabulary, EachLeafFindsItself) {
  const VocabularyTree& tree = builtin_vocabulary();
  ASSERT_EQ(tree.leaf_weights.size(), 10000U);
  const std::size_t leaves = tree.nodes.size() - tree.leaf_weights.size();
  int found = 0;
  for (std::size_t i = 0; i < tree.leaf_weights.size(); ++i) {
    if (word_of(tree, tree.nodes[leaves + i]) == static_cast<int>(i)) ++found;
  }
  EXPECT_GT(found, 6000);  // a leaf's centre may lie nearer to another branch
}

TEST(Vocabulary, BagIsSortedAndSumsToOne) {
  const BagOfWords bag = bag_of_words(builtin_vocabulary(), random_descriptors(500, 1));
  EXPECT_TRUE(std::is_sorted(bag.words.begin(), bag.words.end()));
  EXPECT_EQ(std::adjacent_find(bag.words.begin(), bag.words.end()), bag.words.end());
  EXPECT_NEAR(std::accumulate(bag.weights.begin(), bag.weights.end(), 0.0), 1.0, 1e-4);
}

TEST(Vocabulary, NoDescriptorsGiveAnEmptyBag) {
  EXPECT_TRUE(bag_of_words(builtin_vocabulary(), {}).words.empty());
}

TEST(Vocabulary, NoisyCopyIsMoreSimilarThanAStranger) {
  const auto picture = random_descriptors(500, 1);
  auto noisy = picture;
  std::mt19937 random(3);
  for (Descriptor& d : noisy) {
    for (int flip = 0; flip < 10; ++flip) d[random() % 4] ^= 1ULL << (random() % 64);
  }
  const auto bag = [](const std::vector<Descriptor>& d) {
    return bag_of_words(builtin_vocabulary(), d);
  };
  EXPECT_NEAR(similarity(bag(picture), bag(picture)), 1.0, 1e-4);
  EXPECT_GT(similarity(bag(picture), bag(noisy)),
            2.0 * similarity(bag(picture), bag(random_descriptors(500, 2))));
}

}  // namespace
}  // namespace ydd
