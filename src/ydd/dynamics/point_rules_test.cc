// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/point_rules.h"

#include <utility>

#include <gtest/gtest.h>

#include "ydd/dynamics/scene_testing.h"

namespace ydd {
namespace {

using scene_testing::PaintedScene;

constexpr Box kBox{200, 100, 300, 300};
const MovingRegion kBody{0, Rule::body_depth, kBox, DepthRange{1.0F, 2.0F}};
const MovingRegion kWhole{1, Rule::full_entangled, kBox, std::nullopt};

bool surrounded(const MovingRegion& region, const PointSample& point, const DepthImage& depth_m,
                int reach_px, int axes) {
  return surrounded_by(region, point, surroundings_of(point, depth_m, reach_px), axes);
}

TEST(InRegion, NeedsBoxAndDepth) {
  EXPECT_TRUE(in_region(kBody, {250, 200, 1.5F}));
  EXPECT_FALSE(in_region(kBody, {250, 200, 2.5F}));
  EXPECT_FALSE(in_region(kBody, {250, 200, 0}));
  EXPECT_FALSE(in_region(kBody, {310, 200, 1.5F}));
}

TEST(InRegion, AFullRejectionAsksForNoDepth) {
  EXPECT_TRUE(in_region(kWhole, {250, 200, 0}));
  EXPECT_TRUE(in_region(kWhole, {250, 200, 9}));
  EXPECT_FALSE(in_region(kWhole, {310, 200, 1.5F}));
}

TEST(AtEdge, EachOfTheFourPositions) {
  const MovingRegion body{0, Rule::body_depth, {200, 100, 300, 300}, DepthRange{1.0F, 2.0F}};
  const DepthImage depth = PaintedScene().paint({240, 200, 260, 220}, 1.5F).depth();
  EXPECT_TRUE(at_edge(body, {237, 210, 4}, depth, 3));   // its right is on the body
  EXPECT_TRUE(at_edge(body, {262, 210, 4}, depth, 3));   // left
  EXPECT_TRUE(at_edge(body, {250, 197, 4}, depth, 3));   // below
  EXPECT_TRUE(at_edge(body, {250, 222, 4}, depth, 3));   // above
  EXPECT_FALSE(at_edge(body, {236, 210, 4}, depth, 3));  // four pixels away
  EXPECT_FALSE(at_edge(body, {238, 198, 4}, depth, 3));  // diagonal neighbours are not looked at
}

TEST(AtEdge, TheBoxIsGrownByTheRadius) {
  const DepthImage depth = PaintedScene().paint(kBox, 1.5F).depth();
  EXPECT_TRUE(at_edge(kBody, {302, 200, 4}, depth, 3));
  EXPECT_FALSE(at_edge(kBody, {303, 200, 4}, depth, 3));
  EXPECT_TRUE(at_edge(kBody, {197, 200, 4}, depth, 3));
}

TEST(AtEdge, NeverOfAFullRejection) {
  const DepthImage depth = PaintedScene().paint(kBox, 1.5F).depth();
  EXPECT_FALSE(at_edge(kWhole, {302, 200, 4}, depth, 3));
}

/// A region with a silhouette that fills the left half of the box.
MovingRegion masked_region(std::optional<DepthRange> range) {
  std::vector<std::uint8_t> mask(640U * 480U);
  for (int y = 100; y < 300; ++y) {
    for (int x = 200; x < 250; ++x) mask[static_cast<std::size_t>(y) * 640U + x] = 1;
  }
  return {0, Rule::body_depth, kBox, range, -1, GreyImage(640, 480, std::move(mask))};
}

TEST(Mask, TellsWhatIsInTheRegionWhateverTheDepth) {
  for (const auto& range : {std::optional(DepthRange{1.0F, 2.0F}), std::optional<DepthRange>()}) {
    const MovingRegion region = masked_region(range);
    EXPECT_TRUE(in_region(region, {220, 200, 0}));
    EXPECT_TRUE(in_region(region, {249, 200, 9}));
    EXPECT_FALSE(in_region(region, {250, 200, 1.5F}));
    EXPECT_FALSE(in_region(region, {199, 200, 1.5F}));
  }
}

TEST(Mask, HasEdgesAndNoSurroundings) {
  const DepthImage depth = PaintedScene().depth();
  const MovingRegion region = masked_region(std::nullopt);
  EXPECT_TRUE(at_edge(region, {252, 200, 4}, depth, 3));
  EXPECT_FALSE(at_edge(region, {253, 200, 4}, depth, 3));
  EXPECT_TRUE(at_edge(region, {220, 302, 4}, depth, 3));
  EXPECT_FALSE(at_edge(region, {260, 302, 4}, depth, 3));
  const DepthImage hole = PaintedScene(1.5F).paint({268, 198, 273, 203}, 0.0F).depth();
  EXPECT_TRUE(surrounded(kBody, {270, 200, 0}, hole, 24, 3));
  EXPECT_FALSE(surrounded(masked_region(DepthRange{1.0F, 2.0F}), {270, 200, 0}, hole, 24, 3));
}

TEST(SurroundingsOf, TheNextReadingInEachDirection) {
  PaintedScene scene(0.0F);
  scene.paint({255, 200, 256, 201}, 1)
      .paint({253, 203, 254, 204}, 2)
      .paint({250, 206, 251, 207}, 3);
  scene.paint({248, 202, 249, 203}, 4)
      .paint({241, 200, 242, 201}, 5)
      .paint({249, 199, 250, 200}, 6);
  scene.paint({250, 190, 251, 191}, 7).paint({260, 190, 261, 191}, 8);
  const Surroundings expected = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(surroundings_of({250, 200, 0}, scene.depth(), 10), expected);
  EXPECT_EQ(surroundings_of({250, 200, 0}, scene.depth(), 9)[7], 0);
}

TEST(SurroundedBy, AHoleInABodyButNotBesideIt) {
  PaintedScene scene;
  scene.paint(kBox, 1.5F).paint({240, 180, 260, 220}, 0);  // the shadow of an arm
  scene.paint({290, 100, 320, 300}, 0);                    // the shadow beside the body
  const DepthImage depth = scene.depth();
  EXPECT_TRUE(surrounded(kBody, {250, 200, 0}, depth, 24, 3));
  EXPECT_FALSE(surrounded(kBody, {296, 200, 0}, depth, 24, 1));
}

TEST(SurroundedBy, CountsEnclosedAxes) {
  // A tall slit: the vertical axis ends beyond reach.
  const DepthImage depth = PaintedScene().paint(kBox, 1.5F).paint({245, 100, 255, 300}, 0).depth();
  EXPECT_TRUE(surrounded(kBody, {250, 200, 0}, depth, 24, 3));
  EXPECT_FALSE(surrounded(kBody, {250, 200, 0}, depth, 24, 4));
  EXPECT_FALSE(surrounded(kBody, {250, 200, 0}, depth, 3, 1));
}

TEST(SurroundedBy, ReadingsBehindDoNotCount) {
  const DepthImage depth = PaintedScene(4.0F).paint({240, 180, 260, 220}, 0).depth();
  EXPECT_FALSE(surrounded(kBody, {250, 200, 0}, depth, 24, 1));
}

TEST(SurroundedBy, OnlyPointsWithoutDepthInTheBoxOfARange) {
  const DepthImage depth = PaintedScene(1.5F).depth();
  EXPECT_FALSE(surrounded(kBody, {250, 200, 3.0F}, depth, 24, 1));
  EXPECT_FALSE(surrounded(kBody, {350, 200, 0}, depth, 24, 1));
  EXPECT_FALSE(surrounded(kWhole, {250, 200, 0}, depth, 24, 1));
}

TEST(RuleOf, RegionsBeforeEdgesBeforeSurroundings) {
  const std::vector regions = {kBody,
                               MovingRegion{1, Rule::moved_by_hand, kBox, DepthRange{1.8F, 3.0F}}};
  const DepthImage depth =
      PaintedScene(4.0F).paint({200, 100, 250, 300}, 1.5F).paint({210, 150, 240, 250}, 0).depth();
  const PointRuleOptions options{3, 3, 24, 3};
  EXPECT_EQ(rule_of({205, 120, 1.5F}, regions, depth, options), Rule::body_depth);
  EXPECT_EQ(rule_of({205, 120, 1.9F}, regions, depth, options), Rule::body_depth);
  EXPECT_EQ(rule_of({205, 120, 2.5F}, regions, depth, options), Rule::moved_by_hand);
  EXPECT_EQ(rule_of({252, 200, 4.0F}, regions, depth, options), Rule::edge);
  EXPECT_EQ(rule_of({225, 200, 0}, regions, depth, options), Rule::surrounded);
  EXPECT_EQ(rule_of({280, 200, 4.0F}, regions, depth, options), Rule::kept);
}

TEST(RuleOf, PointsWithAndWithoutDepthHaveEdgesOfTheirOwn) {
  const DepthImage depth = PaintedScene().paint(kBox, 1.5F).depth();
  const std::vector<MovingRegion> regions = {kBody};
  const PointSample measured{302, 200, 4}, unmeasured{302, 200, 0};
  PointRuleOptions options;
  options.surround_px = 0;
  options.edge_radius_px = 3;
  options.unmeasured_edge_px = 0;
  EXPECT_EQ(rule_of(measured, regions, depth, options), Rule::edge);
  EXPECT_EQ(rule_of(unmeasured, regions, depth, options), Rule::kept);
  std::swap(options.edge_radius_px, options.unmeasured_edge_px);
  EXPECT_EQ(rule_of(measured, regions, depth, options), Rule::kept);
  EXPECT_EQ(rule_of(unmeasured, regions, depth, options), Rule::edge);
}

TEST(RuleOf, EdgesAndSurroundingsCanBeOff) {
  const std::vector regions = {kBody};
  const DepthImage depth =
      PaintedScene(4.0F).paint(kBox, 1.5F).paint({240, 180, 260, 220}, 0).depth();
  EXPECT_EQ(rule_of({301, 200, 4.0F}, regions, depth, {}), Rule::kept);
  EXPECT_EQ(rule_of({250, 200, 0}, regions, depth, {}), Rule::kept);
}

}  // namespace
}  // namespace ydd
