// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/culled_keyframes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

CulledKeyFrame below(std::uint32_t parent) { return {{parent, 1}, SE3()}; }

TEST(CulledKeyFrames, FindsWhatWasAddedAndNothingElse) {
  CulledKeyFrames culled;
  EXPECT_EQ(culled.find({3, 1}), nullptr);
  culled.add({200, 1}, below(7));
  culled.add({200, 2}, below(8));  // the slot was used again
  EXPECT_EQ(culled.size(), 2U);
  ASSERT_TRUE(culled.contains({200, 1}));
  EXPECT_EQ(culled.find({200, 1})->parent.slot, 7U);
  EXPECT_EQ(culled.find({200, 2})->parent.slot, 8U);
  EXPECT_FALSE(culled.contains({200, 3}));
  EXPECT_FALSE(culled.contains({100, 1}));
}

TEST(CulledKeyFrames, ACopyStaysAsItIs) {
  CulledKeyFrames culled;
  culled.add({1, 1}, below(0));
  const CulledKeyFrames before = culled;
  culled.add({2, 1}, below(0));
  EXPECT_EQ(before.size(), 1U);
  EXPECT_FALSE(before.contains({2, 1}));
  EXPECT_TRUE(culled.contains({1, 1}));
}

TEST(CulledKeyFrames, AreVisitedInTheOrderOfTheirIds) {
  CulledKeyFrames culled;
  for (const std::uint32_t slot : {300U, 2U, 65U, 64U}) culled.add({slot, 1}, below(0));
  std::vector<std::uint32_t> slots;
  culled.for_each([&](KeyFrameId id, const CulledKeyFrame&) { slots.push_back(id.slot); });
  EXPECT_THAT(slots, testing::ElementsAre(2, 64, 65, 300));
}

}  // namespace
}  // namespace ydd
