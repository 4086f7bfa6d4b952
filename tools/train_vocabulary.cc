// SPDX-License-Identifier: Apache-2.0
// Trains the vocabulary tree of src/ydd/features/vocabulary.inc by k-majority clustering of ORB
// descriptors (Grana et al., "A fast approach for integrating ORB descriptors in the bag of words
// model", 2013) and prints the file.
//
//     ydd_train_vocabulary SEED EVERY FOLDER... > src/ydd/features/vocabulary.inc
//
// FOLDER holds pictures (TUM rgb folders); every EVERY-th is used.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <set>

#include <fmt/format.h>

#include "ydd/features/orb_extractor.h"
#include "ydd/features/vocabulary.h"
#include "ydd/image/decode.h"

namespace {

constexpr int kBranching = 10;
constexpr int kLevels = 4;
constexpr int kIterations = 8;

using Descriptors = std::vector<ydd::Descriptor>;

/// Every bit of the centre is what most of its members have.
ydd::Descriptor majority(const Descriptors& members, const std::vector<int>& mine) {
  std::array<int, 256> votes{};
  for (const int i : mine) {
    for (std::size_t bit = 0; bit < 256; ++bit) {
      votes[bit] +=
          static_cast<int>((members[static_cast<std::size_t>(i)][bit / 64] >> (bit % 64)) & 1U);
    }
  }
  ydd::Descriptor centre{};
  for (std::size_t bit = 0; bit < 256; ++bit) {
    if (2 * votes[bit] > static_cast<int>(mine.size())) centre[bit / 64] |= 1ULL << (bit % 64);
  }
  return centre;
}

/// Start centres far from each other, drawn in proportion to squared distance (k-means++).
Descriptors spread_start(const Descriptors& members, std::mt19937& random) {
  Descriptors centres{members[random() % members.size()]};
  std::vector<double> nearest(members.size(), 1e9);
  while (centres.size() < kBranching) {
    for (std::size_t i = 0; i < members.size(); ++i) {
      const double d = ydd::hamming_distance(members[i], centres.back());
      nearest[i] = std::min(nearest[i], d * d);
    }
    std::discrete_distribution<std::size_t> draw(nearest.begin(), nearest.end());
    centres.push_back(members[draw(random)]);
  }
  return centres;
}

struct Clusters {
  Descriptors centres;
  std::vector<Descriptors> members;
};

Clusters cluster(const Descriptors& members, std::mt19937& random) {
  Clusters out;
  if (members.size() < kBranching) {  // too few: centres repeat the members, empty ones never win
    out.centres.assign(kBranching, ydd::Descriptor{~0ULL, 0, ~0ULL, 0});
    std::copy(members.begin(), members.end(), out.centres.begin());
    out.members.resize(kBranching);
    for (std::size_t i = 0; i < members.size(); ++i) out.members[i] = {members[i]};
    return out;
  }
  out.centres = spread_start(members, random);
  std::vector<std::vector<int>> mine;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    mine.assign(kBranching, {});
    for (std::size_t i = 0; i < members.size(); ++i) {
      const auto nearest = std::min_element(
          out.centres.begin(), out.centres.end(), [&](const auto& a, const auto& b) {
            return ydd::hamming_distance(a, members[i]) < ydd::hamming_distance(b, members[i]);
          });
      mine[static_cast<std::size_t>(nearest - out.centres.begin())].push_back(static_cast<int>(i));
    }
    for (std::size_t c = 0; c < kBranching; ++c) {
      if (!mine[c].empty()) out.centres[c] = majority(members, mine[c]);
    }
  }
  out.members.resize(kBranching);
  for (std::size_t c = 0; c < kBranching; ++c) {
    for (const int i : mine[c]) out.members[c].push_back(members[static_cast<std::size_t>(i)]);
  }
  return out;
}

std::vector<Descriptors> describe_images(int every, const std::vector<std::string>& folders) {
  ydd::OrbExtractor extractor{ydd::OrbOptions()};
  std::vector<Descriptors> images;
  for (const std::string& folder : folders) {
    std::set<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      files.insert(entry.path());
    int i = 0;
    for (const auto& file : files) {
      if (i++ % every != 0) continue;
      const auto image = ydd::load_colour(file);
      if (image) images.push_back(extractor.extract(ydd::to_grey(*image), 1000).descriptors);
    }
  }
  return images;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "usage: ydd_train_vocabulary SEED EVERY FOLDER...\n");
    return 2;
  }
  std::mt19937 random(static_cast<unsigned>(std::atoi(argv[1])));
  const auto images = describe_images(std::atoi(argv[2]), {argv + 3, argv + argc});
  Descriptors all;
  for (const auto& image : images) all.insert(all.end(), image.begin(), image.end());
  if (all.size() < 100000) {
    fmt::print(stderr, "only {} descriptors: give more images\n", all.size());
    return 1;
  }
  Descriptors nodes;
  std::vector<Descriptors> level{all};
  for (int l = 0; l < kLevels; ++l) {
    std::vector<Descriptors> next;
    for (const Descriptors& members : level) {
      Clusters clusters = cluster(members, random);
      nodes.insert(nodes.end(), clusters.centres.begin(), clusters.centres.end());
      for (auto& m : clusters.members) next.push_back(std::move(m));
    }
    level = std::move(next);
  }
  const std::vector<float> none(level.size(), 1.0F);
  const ydd::VocabularyTree tree{kBranching, kLevels, nodes, none};
  std::vector<int> images_with(level.size(), 0);
  for (const auto& image : images) {
    std::set<int> words;
    for (const auto& d : image) words.insert(ydd::word_of(tree, d));
    for (const int w : words) ++images_with[static_cast<std::size_t>(w)];
  }
  fmt::print(
      "// Made by tools/train_vocabulary.cc, seed {}, every {}. picture, {} pictures, {} "
      "descriptors "
      "of:\n// TUM RGB-D freiburg1_xyz (CC BY 4.0) and rooms of this project's simulator.\n"
      "constexpr int kVocabularyBranching = {};\nconstexpr int kVocabularyLevels = {};\n"
      "constexpr std::array<Descriptor, {}> kVocabularyNodes = {{{{\n",
      argv[1], argv[2], images.size(), all.size(), kBranching, kLevels, nodes.size());
  for (const auto& n : nodes) {
    fmt::print("{{{:#x}, {:#x}, {:#x}, {:#x}}},\n", n[0], n[1], n[2], n[3]);
  }
  fmt::print("}}}};\nconstexpr std::array<float, {}> kVocabularyLeafWeights = {{{{\n",
             level.size());
  for (const int n : images_with) {
    const double idf = std::log(static_cast<double>(images.size()) / std::max(n, 1));
    fmt::print("{:.4f}F,\n", n == 0 ? std::log(static_cast<double>(images.size())) : idf);
  }
  fmt::print("}}}};\n");
  return 0;
}
