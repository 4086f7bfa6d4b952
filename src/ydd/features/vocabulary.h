// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ydd/features/features.h"

namespace ydd {

/// A picture as weights of visual words; words ascending, weights sum to 1.
struct BagOfWords {
  std::vector<std::uint16_t> words;
  std::vector<float> weights;
};

/// A tree of binary cluster centres: every node has `branching` children, level by level.
/// Nister and Stewenius, "Scalable recognition with a vocabulary tree", CVPR 2006; binary as in
/// Galvez-Lopez and Tardos, "Bags of binary words", IEEE T-RO 2012.
struct VocabularyTree {
  int branching = 0;
  int levels = 0;
  /// Children of the root, then of its first child, ...: breadth first.
  std::span<const Descriptor> nodes;
  /// Inverse document frequency of each leaf, in the order of the leaves.
  std::span<const float> leaf_weights;
};

/// The tree that comes with the library: 10,000 words, 0.4 MB, compiled in, nothing to load.
/// Made by tools/train_vocabulary; see vocabulary.inc for what from.
const VocabularyTree& builtin_vocabulary();

/// Number of the leaf that a descriptor falls to.
int word_of(const VocabularyTree& tree, const Descriptor& descriptor);

/// Term frequency times inverse document frequency of the words, normalised to sum 1.
BagOfWords bag_of_words(const VocabularyTree& tree, std::span<const Descriptor> descriptors);

/// 1 - |a - b|_1 / 2, in [0, 1].
double similarity(const BagOfWords& a, const BagOfWords& b);

}  // namespace ydd
