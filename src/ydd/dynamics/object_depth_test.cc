// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/object_depth.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "ydd/dynamics/scene_testing.h"

namespace ydd {
namespace {

using scene_testing::PaintedScene;

const ObjectDepthOptions kObjectDepth;
constexpr Box kObject{200, 100, 300, 300};  // centre (250, 200)

TEST(DepthAt, RoundsToTheNearestPixelAndKnowsItsBorders) {
  const DepthImage image(2, 2, {1, 2, 3, std::numeric_limits<float>::infinity()});
  EXPECT_EQ(depth_at(image, 0.4F, 0.4F), 1);
  EXPECT_EQ(depth_at(image, 0.6F, -0.4F), 2);
  EXPECT_EQ(depth_at(image, 0, 1), 3);
  EXPECT_EQ(depth_at(image, 1, 1), 0);  // not finite: no reading
  EXPECT_EQ(depth_at(image, -1, 0), 0);
  EXPECT_EQ(depth_at(image, 0, 2), 0);
}

TEST(CrossDepth, OfAFlatThingIsItsDepth) {
  const DepthImage depth = PaintedScene().paint(kObject, 1.5F).depth();
  EXPECT_FLOAT_EQ(cross_depth(depth, kObject, kObjectDepth).value(), 1.5F);
}

TEST(CrossDepth, KeepsTheNearerSideOfEachArm) {
  // Left half at 2.0, right half at 1.2: the right arm decides the horizontal mean, and the
  // vertical one (through the centre column, which belongs to the right half) agrees.
  const DepthImage depth =
      PaintedScene().paint(kObject, 2.0F).paint({250, 100, 300, 300}, 1.2F).depth();
  EXPECT_FLOAT_EQ(cross_depth(depth, kObject, kObjectDepth).value(), 1.2F);
}

TEST(CrossDepth, AveragesTheThreeNearestReadingsOfTheArm) {
  // Samples lie at 5, 10, ..., 40 px from the centre on the horizontal arms.
  PaintedScene scene;
  scene.paint(kObject, 2.0F);
  scene.paint({253, 195, 257, 205}, 1.0F).paint({268, 195, 272, 205}, 1.3F);
  scene.paint({278, 195, 282, 205}, 1.6F).paint({288, 195, 292, 205}, 1.9F);
  EXPECT_NEAR(cross_depth(scene.depth(), kObject, kObjectDepth).value(), (1.0 + 1.3 + 1.6) / 3,
              1e-6);
}

TEST(CrossDepth, TheVerticalArmMayBeNearer) {
  const DepthImage depth =
      PaintedScene().paint(kObject, 2.0F).paint({240, 210, 260, 300}, 1.4F).depth();
  EXPECT_FLOAT_EQ(cross_depth(depth, kObject, kObjectDepth).value(), 1.4F);
}

TEST(CrossDepth, AnArmFullOfHolesDoesNotWin) {
  // Left arm: one reading at 3.0, the rest holes. By sums it would be the smaller side.
  PaintedScene scene;
  scene.paint(kObject, 0.0F).paint({250, 195, 300, 205}, 1.0F).paint({243, 195, 247, 205}, 3.0F);
  EXPECT_FLOAT_EQ(cross_depth(scene.depth(), kObject, kObjectDepth).value(), 1.0F);
}

TEST(CrossDepth, OneArmIsEnough) {
  PaintedScene scene;
  scene.paint(kObject, 0.0F).paint({245, 210, 255, 300}, 1.7F);
  EXPECT_FLOAT_EQ(cross_depth(scene.depth(), kObject, kObjectDepth).value(), 1.7F);
}

TEST(CrossDepth, FailsWithoutAnyReading) {
  EXPECT_FALSE(cross_depth(PaintedScene().paint(kObject, 0.0F).depth(), kObject, kObjectDepth));
  EXPECT_FALSE(cross_depth(PaintedScene().depth(), {-500, -500, -400, -400}, kObjectDepth));
}

TEST(CentreDepth, IsTheReadingAtTheCentre) {
  const DepthImage depth =
      PaintedScene().paint(kObject, 2.0F).paint({249, 199, 252, 202}, 1.1F).depth();
  EXPECT_FLOAT_EQ(centre_depth(depth, kObject, kObjectDepth).value(), 1.1F);
}

TEST(CentreDepth, LooksRoundAHole) {
  PaintedScene scene;
  scene.paint({240, 190, 261, 211}, 0.0F).paint({254, 200, 255, 201}, 1.2F);
  scene.paint({244, 200, 245, 201}, 0.9F);  // 6 px away; the other is 4 px away
  EXPECT_FLOAT_EQ(centre_depth(scene.depth(), kObject, kObjectDepth).value(), 1.2F);
}

TEST(CentreDepth, OfEquallyNearReadingsTheNearerToTheCamera) {
  PaintedScene scene;
  scene.paint({240, 190, 261, 211}, 0.0F).paint({254, 200, 255, 201}, 1.2F);
  scene.paint({246, 200, 247, 201}, 0.9F);
  EXPECT_FLOAT_EQ(centre_depth(scene.depth(), kObject, kObjectDepth).value(), 0.9F);
}

TEST(CentreDepth, FailsWhenTheWindowIsEmpty) {
  const DepthImage depth = PaintedScene().paint({242, 192, 259, 209}, 0.0F).depth();
  EXPECT_FALSE(centre_depth(depth, kObject, kObjectDepth));
}

TEST(UncoveredDepth, LeavesOutWhatIsCovered) {
  const Box head{200, 100, 300, 200};
  const Box hand{230, 100, 300, 200};
  const DepthImage depth = PaintedScene().paint(head, 2.0F).paint(hand, 0.9F).depth();
  EXPECT_FLOAT_EQ(uncovered_depth(depth, head, std::vector{hand}).value(), 2.0F);
  EXPECT_FALSE(uncovered_depth(depth, head, std::vector{head}));
}

TEST(MeasureObjects, LeavesStaticOnesOutAndKnowsHeads) {
  PaintedScene scene;
  scene.thing("desk", {0, 300, 200, 400}, 2.0F);
  scene.thing("chair", {300, 200, 400, 400}, 1.5F);
  scene.thing("head", {500, 0, 560, 80}, 2.0F).paint({528, 38, 533, 43}, 1.8F);
  scene.thing("cup", {10, 10, 40, 60}, 0.0F);
  const auto objects =
      measure_objects(scene.detections(), ObjectCatalogue::defaults(), scene.depth(), kObjectDepth);
  ASSERT_EQ(objects.size(), 3U);
  EXPECT_EQ(objects[0].detection, 1);
  EXPECT_EQ(objects[0].subcategory, Subcategory::large);
  EXPECT_DOUBLE_EQ(objects[0].extent_m, 0.7);
  EXPECT_FLOAT_EQ(objects[0].depth_m.value(), 1.5F);
  EXPECT_FLOAT_EQ(objects[1].depth_m.value(), 1.8F);
  EXPECT_FALSE(objects[2].depth_m);
}

TEST(MeasureObjects, AHeadBehindAHandIsMeasuredBesideIt) {
  PaintedScene scene;
  scene.thing("head", {200, 100, 300, 200}, 2.0F).thing("hand", {235, 120, 290, 190}, 0.9F);
  const auto measure = [&](bool uncovered) {
    return measure_objects(scene.detections(), ObjectCatalogue::defaults(), scene.depth(),
                           kObjectDepth, uncovered)[0]
        .depth_m.value();
  };
  EXPECT_FLOAT_EQ(measure(false), 0.9F);
  EXPECT_FLOAT_EQ(measure(true), 2.0F);
}

}  // namespace
}  // namespace ydd
