// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracks/sightings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/dynamics/scene_testing.h"

namespace ydd {
namespace {

using scene_testing::PaintedScene;
using testing::IsEmpty;
using testing::SizeIs;

Camera lens() {
  Camera camera;
  camera.fx_px = camera.fy_px = 500;
  camera.cx_px = 320;
  camera.cy_px = 240;
  return camera;
}

/// As the judge has it, without points.
std::vector<Sighting> sightings_in(const PaintedScene& scene, const MotionOdds* odds = nullptr) {
  DynamicsJudge judge({}, ObjectCatalogue::defaults());
  const DepthImage depth_m = scene.depth();
  const Judgement judgement = judge.judge({}, scene.detections(), depth_m);
  return find_sightings({judgement, scene.detections(), depth_m, odds}, lens(),
                        ObjectCatalogue::defaults(), {}, {});
}

/// Nothing moves but the cells [x0, x1) x [y0, y1), at `z_m`.
MotionOdds moving_cells(int x0, int x1, int y0, int y1, float z_m) {
  MotionOdds odds;
  odds.depth.grid = CellGrid(640, 480, 8);
  const auto cells = static_cast<std::size_t>(odds.depth.grid.cells());
  odds.depth.z_m.assign(cells, 4.0F);
  odds.log_odds.assign(cells, -2.0F);
  odds.moves.assign(cells, 0);
  odds.calm_s.assign(cells, 1.0F);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const auto i = static_cast<std::size_t>(odds.depth.grid.index(x, y));
      odds.depth.z_m[i] = z_m;
      odds.log_odds[i] = 3.0F;
      odds.moves[i] = 1;
    }
  }
  return odds;
}

TEST(Sightings, APersonIsWhereItsSurfaceIsAndALittleBehind) {
  const auto seen = sightings_in(PaintedScene().thing("person", {370, 140, 470, 440}, 2.0F));
  ASSERT_THAT(seen, SizeIs(1));
  EXPECT_EQ(seen[0].class_name, "person");
  EXPECT_NEAR(seen[0].p_camera.z(), 2.1, 0.03);                         // half a body behind
  EXPECT_NEAR(seen[0].p_camera.x() / seen[0].p_camera.z(), 0.2, 0.01);  // 420 - 320 of 500 px
  EXPECT_NEAR(seen[0].extent_m.x(), 0.4, 0.05);                         // 100 px at 2 m
  EXPECT_NEAR(seen[0].extent_m.y(), 1.2, 0.08);
  EXPECT_FALSE(seen[0].cut);
  EXPECT_TRUE(seen[0].moves);
}

TEST(Sightings, TheBackgroundInTheBoxIsNoPartOfThePerson) {
  const PaintedScene scene =
      PaintedScene().paint({390, 140, 450, 440}, 2.0F).detect("person", {330, 140, 510, 440});
  const auto seen = sightings_in(scene);
  ASSERT_THAT(seen, SizeIs(1));
  EXPECT_NEAR(seen[0].p_camera.z(), 2.1, 0.03);
  EXPECT_NEAR(seen[0].extent_m.x(), 0.24, 0.04);
}

TEST(Sightings, ErrorGrowsWithTheDepthAndWhereTheBorderCuts) {
  const auto near = sightings_in(PaintedScene().thing("person", {300, 140, 400, 440}, 1.0F));
  const auto far = sightings_in(PaintedScene(6.0F).thing("person", {300, 140, 340, 300}, 4.5F));
  const auto cut = sightings_in(PaintedScene().thing("person", {0, 140, 100, 440}, 1.0F));
  ASSERT_THAT(near, SizeIs(1));
  ASSERT_THAT(far, SizeIs(1));
  ASSERT_THAT(cut, SizeIs(1));
  EXPECT_GT(far[0].covariance_m2(2, 2), near[0].covariance_m2(2, 2) + 0.0005);
  EXPECT_TRUE(cut[0].cut);
  EXPECT_GT(cut[0].covariance_m2(0, 0), 4 * near[0].covariance_m2(0, 0));
}

TEST(Sightings, OfTwoPersonsOneBehindTheOtherEachHasItsOwnDepth) {
  PaintedScene scene;
  scene.paint({300, 100, 420, 440}, 3.0F).paint({240, 80, 340, 460}, 1.5F);
  scene.detect("person", {300, 100, 420, 440}).detect("person", {240, 80, 340, 460});
  scene.detect("head", {345, 100, 380, 140}).detect("head", {270, 80, 310, 130});
  const auto seen = sightings_in(scene);
  ASSERT_THAT(seen, SizeIs(2));
  EXPECT_NEAR(seen[0].p_camera.z(), 1.6, 0.05);
  EXPECT_NEAR(seen[1].p_camera.z(), 3.1, 0.05);
}

TEST(Sightings, WhatIsMostlyHiddenIsNotGuessed) {
  PaintedScene scene;
  scene.paint({240, 80, 400, 460}, 1.5F);
  scene.detect("person", {240, 80, 400, 460}).detect("person", {260, 90, 390, 440});
  EXPECT_THAT(sightings_in(scene), SizeIs(testing::Le(1U)));
}

TEST(Sightings, WithoutAReadingThereIsNone) {
  EXPECT_THAT(sightings_in(PaintedScene(0.0F).detect("person", {300, 140, 400, 440})), IsEmpty());
}

TEST(Sightings, ThingsThatStandAreNotFollowed) {
  EXPECT_THAT(sightings_in(PaintedScene()
                               .thing("person", {500, 140, 600, 440}, 2.0F)
                               .thing("chair", {100, 240, 200, 400}, 3.0F)),
              SizeIs(1));
}

TEST(Sightings, AMovingSurfaceOfNoNameIsAThing) {
  const MotionOdds odds = moving_cells(10, 18, 20, 28, 2.0F);
  const auto seen = sightings_in(PaintedScene(), &odds);
  ASSERT_THAT(seen, SizeIs(1));
  EXPECT_EQ(seen[0].class_name, kThing);
  EXPECT_NEAR(seen[0].p_camera.z(), 2.0, 0.01);
  EXPECT_NEAR(*seen[0].log_odds, 3.0F, 1e-4F);
}

TEST(Sightings, IsSureWhenTheDetectorIsOrWhenItIsSeenToMove) {
  const PaintedScene scene = PaintedScene().thing("person", {320, 160, 400, 400}, 2.0F);
  const MotionOdds moves = moving_cells(40, 50, 20, 50, 2.0F);
  const MotionOdds nothing_known = MotionOdds{};
  for (const bool sure : {false, true}) {
    Detections detections = scene.detections();
    detections[0].sure = sure;
    for (const MotionOdds* odds : {&moves, &nothing_known}) {
      DynamicsOptions options;
      options.variant = Variant::evidence;
      DynamicsJudge judge(options, ObjectCatalogue::defaults());
      const MotionOdds* known = odds->empty() ? nullptr : odds;
      const DepthImage depth_m = scene.depth();
      const Judgement judgement = judge.judge({}, detections, depth_m, known);
      const auto seen = find_sightings({judgement, detections, depth_m, known}, lens(),
                                       ObjectCatalogue::defaults(), {}, {});
      ASSERT_THAT(seen, SizeIs(1));
      EXPECT_EQ(seen[0].sure, sure || known != nullptr);
      EXPECT_TRUE(seen[0].moves) << "its points are left out all the same";
    }
  }
}

TEST(Sightings, ASpeckIsNoThingAndNeitherIsALimb) {
  const MotionOdds speck = moving_cells(10, 12, 20, 22, 2.0F);
  EXPECT_THAT(sightings_in(PaintedScene(), &speck), IsEmpty());
  const MotionOdds limb = moving_cells(40, 48, 20, 28, 2.0F);  // px 320 to 384, beside the box
  EXPECT_THAT(sightings_in(PaintedScene().thing("person", {370, 140, 470, 440}, 2.0F), &limb),
              SizeIs(1));
}

}  // namespace
}  // namespace ydd
