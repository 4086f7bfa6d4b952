// SPDX-License-Identifier: Apache-2.0
#include "ydd/viewer/dense_cloud.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "ydd/system/picture_testing.h"

namespace ydd {
namespace {

using testing_world::Wall;

/// A frame of the wall, two metres away, with a person one metre away on the left half.
struct CloudScene {
  Wall wall{10};
  RgbdFrame frame = wall.frame(0);
  FrameReport report;
  std::vector<RejectedPoint> rejected;

  CloudScene() {
    std::vector<float> depth_m(320U * 240U, 2.0F);
    for (std::size_t i = 0; i < depth_m.size(); ++i) {
      if (i % 320U < 160U) depth_m[i] = 1.0F;
    }
    frame.depth_m = DepthImage(320, 240, std::move(depth_m));
  }
  void judge(Rule rule, std::optional<DepthRange> range) {
    ObjectJudgement person;
    person.box = {0, 0, 200, 240};  // reaches beyond the person
    person.rule = rule;
    person.range = range;
    report.judgement.objects.push_back(person);
  }
  Vertices surface() {
    report.filtered = std::make_shared<const FilteredFeatures>(
        FilteredFeatures{std::make_shared<const Features>(), rejected});
    return static_surface(frame, report, wall.camera());
  }
};

long nearer_than(const Vertices& points, float depth_m) {
  return std::count_if(points.begin(), points.end(),
                       [&](const SceneVertex& v) { return v.p_world[2] < depth_m; });
}

TEST(StaticSurface, TakesEveryFifthPixelWhereDepthIs) {
  CloudScene scene;
  const Vertices points = scene.surface();
  EXPECT_EQ(points.size(), 64U * 48U);
  EXPECT_EQ(nearer_than(points, 1.5F), 32 * 48);
  // Column 63 is at x = 315 px: there the wall is.
  const Camera& camera = scene.wall.camera();
  const Eigen::Vector3d expected = camera.unproject({315, 0}, 2.0);
  EXPECT_NEAR(points[63].p_world[0], expected.x(), 1e-5);
  EXPECT_NEAR(points[63].p_world[1], expected.y(), 1e-5);
  EXPECT_EQ(points[63].rgba[0], scene.frame.colour(315, 0)[2]);
}

TEST(StaticSurface, LeavesOutWhatMovesInItsDepthRangeOnly) {
  CloudScene scene;
  scene.judge(Rule::body_depth, DepthRange{0.8F, 1.3F});
  const Vertices points = scene.surface();
  EXPECT_EQ(nearer_than(points, 1.5F), 0);
  EXPECT_EQ(points.size(), 32U * 48U);  // the wall beside the person, inside the box, too
}

TEST(StaticSurface, WithoutARangeTheWholeBoxGoes) {
  CloudScene scene;
  scene.judge(Rule::full_small_box, {});
  EXPECT_LT(scene.surface().size(), 24U * 48U);
}

TEST(StaticSurface, AnObjectThatStandsStillStays) {
  CloudScene scene;
  scene.judge(Rule::kept, {});
  EXPECT_EQ(scene.surface().size(), 64U * 48U);
}

TEST(StaticSurface, WhatLiesRoundARejectedPointGoes) {
  CloudScene scene;
  scene.rejected.push_back({{80, 100, 0, 10, 0}, 1.0F, Rule::bridged});
  const std::size_t left = scene.surface().size();
  EXPECT_LT(left, 64U * 48U - 20U);
  EXPECT_GT(left, 64U * 48U - 60U);
}

TEST(StaticSurface, NoReadingAndFarAwayAreLeftOut) {
  CloudScene scene;
  scene.frame = scene.wall.dark_frame(0);
  EXPECT_TRUE(scene.surface().empty());
  scene.frame = scene.wall.frame(0);
  scene.report.filtered = std::make_shared<const FilteredFeatures>();
  EXPECT_TRUE(static_surface(scene.frame, scene.report, scene.wall.camera(), 5, 1.9).empty());
}

TEST(DenseCloud, AddsAFrameOnlyWhenItLooksAtSomethingNew) {
  const Wall wall(120, 4);
  SystemOptions options;
  options.deterministic = true;
  SlamSystem system(wall.camera(), options, ObjectCatalogue::defaults(), nullptr);
  DenseCloud cloud;
  int added = 0;
  for (int i = 0; i < 40; ++i) {
    LiveFrame live;
    live.frame = wall.frame(i);
    live.report = std::make_shared<const FrameReport>(system.process(live.frame).value());
    live.atlas = system.atlas();
    const bool fresh = cloud.add(live, wall.camera());
    added += fresh ? 1 : 0;
    EXPECT_TRUE(fresh || i > 0);
    EXPECT_FALSE(cloud.add(live, wall.camera()));  // not twice
  }
  // 40 frames, 4 px of 2 m / 260 px each: 1.2 m, a patch for each quarter of a metre.
  EXPECT_GE(added, 4);
  EXPECT_LE(added, 6);
  EXPECT_EQ(cloud.patches().size(), static_cast<std::size_t>(added));
}

}  // namespace
}  // namespace ydd
