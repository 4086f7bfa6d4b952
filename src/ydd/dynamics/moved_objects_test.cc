// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/moved_objects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/dynamics/scene_testing.h"

namespace ydd {
namespace {

using scene_testing::PaintedScene;
using testing::Each;
using testing::IsEmpty;
using testing::SizeIs;

const MovedObjectOptions kMoved;
constexpr Box kCup{200, 200, 260, 260};
constexpr double kAllowance_m = 0.2;

SceneObject object(Subcategory subcategory, const Box& box, double extent_m,
                   std::optional<float> depth_m) {
  SceneObject result;
  result.subcategory = subcategory;
  result.box = box;
  result.extent_m = extent_m;
  result.depth_m = depth_m;
  return result;
}
SceneObject hand_at(const Box& box, std::optional<float> depth_m) {
  return object(Subcategory::hand, box, 0.18, depth_m);
}
SceneObject cup(std::optional<float> depth_m) {
  return object(Subcategory::small, kCup, 0.2, depth_m);
}

TEST(PushedSides, OneInnerSideIsPushedByThree) {
  // The hand covers the left third: only the contact's right side lies inside the cup.
  const Box grip{180, 190, 220, 270};
  PaintedScene scene(0.0F);
  scene.paint({222, 200, 223, 260}, 1.0F);  // column 219 + 3
  EXPECT_THAT(pushed_side_readings(scene.depth(), grip, kCup, kMoved), SizeIs(60));
}

TEST(PushedSides, ByOneWhereLessThanThreeRemain) {
  const Box grip{180, 190, 258, 270};  // last contact column 257, last cup column 259
  PaintedScene scene(0.0F);
  scene.paint({258, 200, 259, 260}, 1.0F);
  EXPECT_THAT(pushed_side_readings(scene.depth(), grip, kCup, kMoved), SizeIs(60));
}

TEST(PushedSides, ACornerHasTwo) {
  const Box grip{180, 180, 220, 230};
  PaintedScene scene(0.0F);
  scene.paint({222, 200, 223, 230}, 1.0F);  // right side
  scene.paint({200, 232, 220, 233}, 1.0F);  // lower side
  EXPECT_THAT(pushed_side_readings(scene.depth(), grip, kCup, kMoved), SizeIs(30 + 20));
}

TEST(PushedSides, AHandInsideHasFour) {
  const Box grip{220, 220, 240, 240};
  const DepthImage depth = PaintedScene(1.0F).depth();
  const auto readings = pushed_side_readings(depth, grip, kCup, kMoved);
  EXPECT_THAT(readings, SizeIs(80));
  EXPECT_THAT(readings, Each(1.0F));
}

TEST(PushedSides, NoneWhenApartOrCovered) {
  const DepthImage depth = PaintedScene(1.0F).depth();
  EXPECT_THAT(pushed_side_readings(depth, {0, 0, 100, 100}, kCup, kMoved), IsEmpty());
  EXPECT_THAT(pushed_side_readings(depth, {150, 150, 300, 300}, kCup, kMoved), IsEmpty());
}

TEST(MovedByHand, ACupInAHand) {
  const Box grip{180, 190, 220, 270};
  const DepthImage depth = PaintedScene().paint(kCup, 1.0F).paint(grip, 0.97F).depth();
  EXPECT_TRUE(moved_by_hand(depth, hand_at(grip, 0.97F), cup(1.0F), kAllowance_m, kMoved));
}

TEST(MovedByHand, AHandInFrontOfACupOnADesk) {
  const Box grip{180, 190, 220, 270};
  const DepthImage depth = PaintedScene().paint(kCup, 1.6F).paint(grip, 1.0F).depth();
  EXPECT_FALSE(moved_by_hand(depth, hand_at(grip, 1.0F), cup(1.6F), kAllowance_m, kMoved));
}

TEST(MovedByHand, TheHandMustLieInTheRangeOfTheObject) {
  // The pushed side is at the hand's depth, but the object's measured depth is not.
  const Box grip{180, 190, 220, 270};
  const DepthImage depth = PaintedScene().paint(kCup, 1.1F).paint(grip, 1.0F).depth();
  EXPECT_FALSE(moved_by_hand(depth, hand_at(grip, 1.0F), cup(1.1F), kAllowance_m, kMoved));
  EXPECT_TRUE(moved_by_hand(depth, hand_at(grip, 1.07F), cup(1.1F), kAllowance_m, kMoved));
}

TEST(MovedByHand, ThreeReadingsMakeAContactTwoDoNot) {
  const Box grip{180, 190, 220, 270};
  const auto moved = [&](float rows) {
    const DepthImage depth =
        PaintedScene().paint(kCup, 3.0F).paint({221, 200, 224, 200 + rows}, 1.0F).depth();
    return moved_by_hand(depth, hand_at(grip, 1.0F), cup(1.0F), kAllowance_m, kMoved);
  };
  EXPECT_FALSE(moved(2));
  EXPECT_TRUE(moved(3));
}

TEST(MovedByHand, AHandAroundAWholeThing) {
  const Box grip{150, 150, 300, 300};
  const DepthImage depth = PaintedScene().depth();
  EXPECT_TRUE(moved_by_hand(depth, hand_at(grip, 1.0F), cup(0.98F), kAllowance_m, kMoved));
  EXPECT_FALSE(moved_by_hand(depth, hand_at(grip, 1.0F), cup(0.7F), kAllowance_m, kMoved));
}

TEST(MovedByHand, NeverWithoutDepthOrApart) {
  const Box grip{180, 190, 220, 270};
  const DepthImage depth = PaintedScene(1.0F).depth();
  EXPECT_FALSE(moved_by_hand(depth, hand_at(grip, std::nullopt), cup(1.0F), kAllowance_m, kMoved));
  EXPECT_FALSE(moved_by_hand(depth, hand_at(grip, 1.0F), cup(std::nullopt), kAllowance_m, kMoved));
  EXPECT_FALSE(
      moved_by_hand(depth, hand_at({0, 0, 50, 50}, 1.0F), cup(1.0F), kAllowance_m, kMoved));
}

class NearBody : public testing::Test {
 protected:
  std::vector<SceneObject> objects_ = {object(Subcategory::person, {100, 50, 250, 450}, 1.0, 2.0F),
                                       hand_at({90, 200, 120, 240}, 2.0F),
                                       hand_at({240, 200, 280, 240}, 2.0F),
                                       hand_at({150, 400, 180, 430}, std::nullopt)};
  SceneObject chair_ = object(Subcategory::large, {200, 250, 350, 470}, 0.7, 2.2F);
  DepthRange range_{1.8F, 3.0F};

  bool moved(std::vector<int> hands) const {
    return moved_near_body(objects_, {0, 0, false, -1, std::move(hands)}, range_, chair_, 2);
  }
};

TEST_F(NearBody, WithHiddenHandsTheDepthDecides) {
  EXPECT_TRUE(moved({}));
  EXPECT_TRUE(moved({1}));
  chair_.depth_m = 3.2F;
  EXPECT_FALSE(moved({}));
  chair_.depth_m.reset();
  EXPECT_FALSE(moved({}));
}

TEST_F(NearBody, TwoHandsInSightMoveNothingElse) { EXPECT_FALSE(moved({1, 2})); }

TEST_F(NearBody, AHandWithoutDepthCountsAsHidden) { EXPECT_TRUE(moved({1, 3})); }

TEST_F(NearBody, TheBoxesMustMeet) {
  chair_.box = {400, 250, 500, 470};
  EXPECT_FALSE(moved({}));
}

}  // namespace
}  // namespace ydd
