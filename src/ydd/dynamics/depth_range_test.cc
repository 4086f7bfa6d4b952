// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/depth_range.h"

#include <cmath>

#include <gtest/gtest.h>

namespace ydd {
namespace {

const DepthExtents kExtents;
constexpr double kAllowance = 0.2;

void expect_range(const std::optional<DepthRange>& range, double min_m, double max_m) {
  ASSERT_TRUE(range);
  EXPECT_NEAR(range->min_m, min_m, 1e-6);
  EXPECT_NEAR(range->max_m, max_m, 1e-6);
}

BodyDepths depths(std::optional<float> person, std::optional<float> head,
                  std::optional<float> nearest = {}, std::optional<float> farthest = {}) {
  return {person, head, nearest, farthest};
}

TEST(DepthRange, ContainsBothEndsButNeverAMissingReading) {
  const DepthRange range{1, 2};
  EXPECT_TRUE(range.contains(1));
  EXPECT_TRUE(range.contains(2));
  EXPECT_FALSE(range.contains(0.999F));
  EXPECT_FALSE(range.contains(2.001F));
  EXPECT_FALSE((DepthRange{-1, 2}.contains(0)));
  EXPECT_FALSE((DepthRange{-1, 2}.contains(std::nanf(""))));
}

TEST(DepthRange, SingleRangesOfEquation4) {
  expect_range(head_range(2.0F, kExtents), 2.0 + 0.1 - 0.5, 2.0 + 0.1 + 0.5);
  expect_range(hands_range(1.5F, 1.9F, kExtents, kAllowance), 1.5 - 0.2 * 0.18, 1.9 + 0.18);
  expect_range(person_range(2.0F, kExtents, kAllowance), 2.0 - 0.2, 2.0 + 1.0);
}

TEST(DepthRange, OfAnAutomaticObjectEquation5) {
  expect_range(object_range(2.0F, 0.7, kAllowance), 2.0 - 0.14, 2.7);
}

TEST(BodyRange, HeadAndHandAreJoined) {
  expect_range(body_range(depths(1.0F, 2.0F, 1.3F, 1.9F), kExtents, kAllowance), 1.3 - 0.036, 2.6);
  expect_range(body_range(depths(1.0F, 2.0F, 1.9F, 2.9F), kExtents, kAllowance), 1.6, 3.08);
}

TEST(BodyRange, HeadAloneUnlessThePersonLiesOutside) {
  expect_range(body_range(depths(1.8F, 2.0F), kExtents, kAllowance), 1.6, 2.6);
  expect_range(body_range(depths(1.5F, 2.0F), kExtents, kAllowance), 1.3, 2.6);
  expect_range(body_range(depths(2.7F, 2.0F), kExtents, kAllowance), 1.6, 3.7);
  expect_range(body_range(depths({}, 2.0F), kExtents, kAllowance), 1.6, 2.6);
}

TEST(BodyRange, WithoutAHeadPersonAndHand) {
  expect_range(body_range(depths(2.0F, {}, 1.5F, 1.5F), kExtents, kAllowance), 1.464, 3.0);
  expect_range(body_range(depths(2.0F, {}), kExtents, kAllowance), 1.8, 3.0);
}

TEST(BodyRange, FailsWhenTheNeededDepthFailed) {
  EXPECT_FALSE(body_range(depths({}, {}), kExtents, kAllowance));
  EXPECT_FALSE(body_range(depths({}, {}, 1.5F, 1.5F), kExtents, kAllowance));
}

}  // namespace
}  // namespace ydd
