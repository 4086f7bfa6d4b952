// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/box_geometry.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

constexpr Box kBox{100, 100, 200, 300};

TEST(Disjoint, EachOfTheFourInequalities) {
  EXPECT_TRUE(disjoint(kBox, {0, 100, 99, 300}));      // left
  EXPECT_TRUE(disjoint(kBox, {100, 0, 200, 99}));      // above
  EXPECT_TRUE(disjoint(kBox, {201, 100, 300, 300}));   // right
  EXPECT_TRUE(disjoint(kBox, {100, 301, 200, 400}));   // below
  EXPECT_FALSE(disjoint(kBox, {150, 200, 160, 210}));  // inside
  EXPECT_FALSE(disjoint(kBox, {0, 0, 101, 101}));      // corner
}

TEST(Disjoint, TouchingBoxesAreNot) {
  EXPECT_FALSE(disjoint(kBox, {200, 100, 300, 300}));
  EXPECT_FALSE(disjoint(kBox, {0, 100, 100, 300}));
}

TEST(CoincidenceDegree, IsTheShareOfTheFirstBox) {
  const Box half{150, 100, 350, 300};
  EXPECT_FLOAT_EQ(coincidence_degree(kBox, half), 0.5F);
  EXPECT_FLOAT_EQ(coincidence_degree(half, kBox), 0.25F);
  EXPECT_FLOAT_EQ(coincidence_degree(kBox, kBox), 1.0F);
  EXPECT_FLOAT_EQ(coincidence_degree(kBox, {300, 0, 400, 50}), 0.0F);
  EXPECT_FLOAT_EQ(coincidence_degree({}, kBox), 0.0F);
}

TEST(CoincidenceDegree, OfAPersonIsTheLargestOverAllOthers) {
  const std::vector<Box> boxes = {
      kBox, {180, 100, 280, 300}, {130, 100, 230, 300}, {400, 0, 500, 9}};
  const std::vector<float> degrees = largest_coincidence(boxes);
  ASSERT_EQ(degrees.size(), 4U);
  EXPECT_FLOAT_EQ(degrees[0], 0.7F);
  EXPECT_FLOAT_EQ(degrees[1], 0.5F);
  EXPECT_FLOAT_EQ(degrees[2], 0.7F);
  EXPECT_FLOAT_EQ(degrees[3], 0.0F);
}

TEST(Scaled, KeepsTheCentre) {
  EXPECT_EQ(scaled({10, 20, 30, 60}, 2), (Box{0, 0, 40, 80}));
  EXPECT_EQ(scaled({10, 20, 30, 60}, 1), (Box{10, 20, 30, 60}));
}

}  // namespace
}  // namespace ydd
