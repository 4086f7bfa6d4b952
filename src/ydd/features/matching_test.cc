// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/matching.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

Descriptor with_bits(int count) {
  Descriptor d{};
  for (int i = 0; i < count; ++i) d[i / 64] |= std::uint64_t{1} << (i % 64);
  return d;
}

// Some of the points lie outside the image, as undistortion makes them.
Features scattered_features(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> x(-40.0F, 680.0F), y(-40.0F, 520.0F);
  Features f;
  for (int i = 0; i < count; ++i) {
    const float v = y(random);
    f.undistorted_px.emplace_back(x(random), v);
    f.keypoints.push_back({.octave = static_cast<int>(random() % 8)});
    f.descriptors.push_back({random(), random(), random(), random()});
  }
  return f;
}

TEST(KeypointGrid, FindsWhatBruteForceFinds) {
  const Features f = scattered_features(1500, 7);
  const KeypointGrid grid(f, Camera{});
  std::mt19937 random(8);
  std::uniform_real_distribution<float> x(-80.0F, 720.0F), y(-80.0F, 560.0F), r(0.0F, 90.0F);
  std::vector<int> found;
  for (int trial = 0; trial < 300; ++trial) {
    const float cx = x(random), cy = y(random), radius = r(random);
    const int lo = static_cast<int>(random() % 8), hi = lo + static_cast<int>(random() % 3);
    std::vector<int> expected;
    for (int i = 0; i < 1500; ++i) {
      const Eigen::Vector2f& p = f.undistorted_px[i];
      const int octave = f.keypoints[i].octave;
      if (std::abs(p.x() - cx) < radius && std::abs(p.y() - cy) < radius && octave >= lo &&
          octave <= hi) {
        expected.push_back(i);
      }
    }
    grid.query(cx, cy, radius, lo, hi, found);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected) << "trial " << trial;
  }
}

TEST(KeypointGrid, GivesIndicesInCellOrder) {
  Features f;
  f.undistorted_px = {{40, 40}, {3, 3}, {40, 3}, {2, 2}};
  f.keypoints.resize(4);
  const KeypointGrid grid(f, Camera{});
  std::vector<int> found{99};
  grid.query(20, 20, 100, 0, 0, found);
  EXPECT_THAT(found, ElementsAre(1, 3, 2, 0));
}

TEST(KeypointGrid, AnEmptyOneFindsNothing) {
  std::vector<int> found{1};
  KeypointGrid().query(10, 10, 100, 0, 7, found);
  EXPECT_THAT(found, IsEmpty());
  KeypointGrid(Features{}, Camera{}).query(10, 10, 100, 0, 7, found);
  EXPECT_THAT(found, IsEmpty());
}

TEST(BestMatch, GivesNearestAndSecondWithTheirOctaves) {
  Features f;
  f.descriptors = {with_bits(90), with_bits(10), with_bits(30), with_bits(10)};
  f.keypoints.resize(4);
  for (int i = 0; i < 4; ++i) f.keypoints[i].octave = i;
  const BestMatch m = best_match(Descriptor{}, f, std::vector<int>{0, 1, 2, 3});
  EXPECT_EQ(m.index, 1);
  EXPECT_EQ(m.distance, 10);
  EXPECT_EQ(m.octave, 1);
  EXPECT_EQ(m.second_distance, 10);
  EXPECT_EQ(m.second_octave, 3);
}

TEST(BestMatch, OfNoCandidatesIsNone) {
  const BestMatch m = best_match(Descriptor{}, Features{}, {});
  EXPECT_EQ(m.index, -1);
  EXPECT_EQ(m.distance, 257);
  EXPECT_EQ(m.second_distance, 257);
}

TEST(ConsistentRotation, DropsWhatTurnsOtherwise) {
  std::vector<float> differences(50, 0.3F);
  differences.insert(differences.end(), 3, 2.0F);  // below a tenth of the fullest
  const std::vector<bool> keep = consistent_rotation(differences);
  EXPECT_THAT(std::vector<bool>(keep.begin(), keep.begin() + 50), Each(true));
  EXPECT_THAT(std::vector<bool>(keep.begin() + 50, keep.end()), Each(false));
}

TEST(ConsistentRotation, KeepsOnlyTheThreeFullestBins) {
  std::vector<float> differences;
  for (int bin = 0; bin < 4; ++bin) differences.insert(differences.end(), 10 - bin, float(bin));
  const std::vector<bool> keep = consistent_rotation(differences);
  EXPECT_EQ(std::count(keep.begin(), keep.end(), true), 10 + 9 + 8);
  EXPECT_FALSE(keep.back());
}

TEST(ConsistentRotation, IsPeriodicAndDoesNotSplitNoRotation) {
  constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;
  std::vector<float> differences;
  for (int i = 0; i < 20; ++i) {
    differences.push_back(0.05F);
    differences.push_back(-0.05F);
    differences.push_back(kTurn - 0.05F);
    differences.push_back(-kTurn + 0.05F);
  }
  // If the above fell into two bins, these would push one of the later ones out.
  differences.insert(differences.end(), 9, 1.0F);
  differences.insert(differences.end(), 9, 2.0F);
  EXPECT_THAT(consistent_rotation(differences), Each(true));
}

TEST(ConsistentRotation, OfNothingIsNothing) { EXPECT_TRUE(consistent_rotation({}).empty()); }

TEST(MedianDescriptor, IsTheOneInTheMiddle) {
  const std::vector<Descriptor> chain = {with_bits(0), with_bits(52), with_bits(50), with_bits(47),
                                         with_bits(200)};
  EXPECT_EQ(median_descriptor(chain), with_bits(50));
}

TEST(MedianDescriptor, TiesGoToTheFirst) {
  const std::vector<Descriptor> two = {with_bits(7), with_bits(3)};
  EXPECT_EQ(median_descriptor(two), with_bits(7));
  const std::vector<Descriptor> corners = {Descriptor{1}, Descriptor{2}, Descriptor{4}};
  EXPECT_EQ(median_descriptor(corners), corners[0]);
  EXPECT_THROW(median_descriptor({}), std::logic_error);
}

TEST(Hamming, CountsDifferingBits) {
  EXPECT_EQ(hamming_distance(with_bits(0), with_bits(256)), 256);
  EXPECT_EQ(hamming_distance(with_bits(70), with_bits(200)), 130);
}

}  // namespace
}  // namespace ydd
