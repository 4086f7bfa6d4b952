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

TEST(CulledKeyFrames, DifferencesFromACopyAreVisitedAndLittleElse) {
  CulledKeyFrames culled;
  for (std::uint32_t slot = 0; slot < 300; slot += 3) culled.add({slot, 1}, below(slot + 1));
  const CulledKeyFrames before = culled;
  culled.add({3, 2}, below(77));
  culled.add({1000, 1}, below(78));
  const auto different = [](const CulledKeyFrames& now, const CulledKeyFrames& then) {
    std::vector<KeyFrameId> ids;
    now.for_each_difference(then, [&](KeyFrameId id, const CulledKeyFrame&) { ids.push_back(id); });
    return ids;
  };
  const std::vector<KeyFrameId> ids = different(culled, before);
  EXPECT_THAT(ids, testing::IsSupersetOf({KeyFrameId{3, 2}, KeyFrameId{1000, 1}}));
  EXPECT_LT(ids.size(), 30U);
  EXPECT_THAT(different(before, culled), testing::Not(testing::Contains(KeyFrameId{3, 2})));
  EXPECT_TRUE(different(culled, culled).empty());
  EXPECT_EQ(different(culled, CulledKeyFrames()).size(), culled.size());
}

}  // namespace
}  // namespace ydd
