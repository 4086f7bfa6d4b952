// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/vocabulary.h"

#include <algorithm>

namespace ydd {
namespace {

#include "ydd/features/vocabulary.inc"

}  // namespace

const VocabularyTree& builtin_vocabulary() {
  static constexpr VocabularyTree kTree{kVocabularyBranching, kVocabularyLevels,
                                        std::span<const Descriptor>(kVocabularyNodes),
                                        std::span<const float>(kVocabularyLeafWeights)};
  return kTree;
}

int word_of(const VocabularyTree& tree, const Descriptor& descriptor) {
  // On level l the nodes stand together; a node's children keep its order.
  std::size_t level_start = 0;
  std::size_t level_size = static_cast<std::size_t>(tree.branching);
  std::size_t parent = 0;
  for (int level = 0; level < tree.levels; ++level) {
    const std::size_t first = parent * static_cast<std::size_t>(tree.branching);
    std::size_t best = first;
    int best_distance = 257;
    for (std::size_t child = first; child < first + static_cast<std::size_t>(tree.branching);
         ++child) {
      const int distance = hamming_distance(tree.nodes[level_start + child], descriptor);
      if (distance >= best_distance) continue;
      best_distance = distance;
      best = child;
    }
    parent = best;
    level_start += level_size;
    level_size *= static_cast<std::size_t>(tree.branching);
  }
  return static_cast<int>(parent);
}

BagOfWords bag_of_words(const VocabularyTree& tree, std::span<const Descriptor> descriptors) {
  std::vector<std::uint16_t> words;
  words.reserve(descriptors.size());
  for (const Descriptor& d : descriptors) {
    words.push_back(static_cast<std::uint16_t>(word_of(tree, d)));
  }
  std::sort(words.begin(), words.end());
  BagOfWords bag;
  float sum = 0;
  for (const std::uint16_t word : words) {
    const float weight = tree.leaf_weights[word];
    if (weight <= 0) continue;
    sum += weight;
    if (!bag.words.empty() && bag.words.back() == word) {
      bag.weights.back() += weight;
    } else {
      bag.words.push_back(word);
      bag.weights.push_back(weight);
    }
  }
  for (float& weight : bag.weights) weight /= sum;
  return bag;
}

double similarity(const BagOfWords& a, const BagOfWords& b) {
  // Of two vectors with sum 1: 1 - |a - b|_1 / 2 = sum of the smaller entries.
  double common = 0;
  for (std::size_t i = 0, k = 0; i < a.words.size() && k < b.words.size();) {
    if (a.words[i] < b.words[k]) {
      ++i;
    } else if (b.words[k] < a.words[i]) {
      ++k;
    } else {
      common += static_cast<double>(std::min(a.weights[i++], b.weights[k++]));
    }
  }
  return common;
}

}  // namespace ydd
