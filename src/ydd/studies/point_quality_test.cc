// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/point_quality.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace ydd {
namespace {

Keypoint at(float x, float y) { return {x, y, 0, 1, 0}; }

/// 40 x 40 pixels of which columns 10 to 19 move; a person box over columns 5 to 34.
class Quality : public testing::Test {
 protected:
  static Image<std::uint8_t> mask() {
    std::vector<std::uint8_t> pixels(40 * 40, 0);
    for (std::size_t y = 0; y < 40; ++y) {
      for (std::size_t x = 10; x < 20; ++x) pixels[y * 40 + x] = 7;
    }
    return {40, 40, pixels};
  }
  const std::vector<Box> persons_ = {{5, 0, 35, 40}};
  const std::vector<Keypoint> points_ = {at(15, 5),  at(12, 9), at(19.4F, 9), at(21, 9),
                                         at(30, 30), at(8, 30), at(2, 2),     at(38, 2)};
};

TEST_F(Quality, CountsByMaskBoxAndSilhouette) {
  using enum Rule;
  const PointQuality quality = point_quality({body_depth, kept, edge, edge, kept, kept, kept, box},
                                             points_, mask(), persons_);
  EXPECT_EQ(quality.moving, 3);
  EXPECT_EQ(quality.moving_rejected, 2);
  EXPECT_EQ(quality.stationary, 5);
  EXPECT_EQ(quality.stationary_rejected, 2);
  EXPECT_EQ(quality.in_person, 3);
  EXPECT_EQ(quality.in_person_kept, 2);
  EXPECT_EQ(quality.inner, 1);
  EXPECT_EQ(quality.inner_kept, 1);
  EXPECT_EQ(quality.rejected(), 4);
  EXPECT_DOUBLE_EQ(quality.recall(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(quality.precision(), 0.5);
  EXPECT_DOUBLE_EQ(quality.kept_in_persons(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(quality.kept_off_silhouettes(), 1.0);
}

TEST_F(Quality, Sums) {
  const std::vector<Rule> all(points_.size(), Rule::box);
  PointQuality sum = point_quality(all, points_, mask(), persons_);
  sum += sum;
  EXPECT_EQ(sum.moving, 6);
  EXPECT_EQ(sum.inner, 2);
  EXPECT_DOUBLE_EQ(sum.recall(), 1.0);
  EXPECT_DOUBLE_EQ(sum.kept_in_persons(), 0.0);
}

TEST_F(Quality, NothingToFindIsAllFound) {
  const PointQuality none;
  EXPECT_DOUBLE_EQ(none.recall(), 1.0);
  EXPECT_DOUBLE_EQ(none.precision(), 1.0);
  EXPECT_DOUBLE_EQ(none.kept_in_persons(), 1.0);
}

TEST_F(Quality, OneRuleForEachPoint) {
  EXPECT_THROW(point_quality({Rule::kept}, points_, mask(), persons_), std::logic_error);
}

}  // namespace
}  // namespace ydd
