// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/annotate.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>

#include <gtest/gtest.h>

namespace ydd {
namespace {

constexpr Bgr kBlack{0, 0, 0};

/// A black picture with points in the free right half, away from text and legend.
struct Scene {
  RgbdFrame frame;
  FrameReport report;
  Features features;
  std::vector<RejectedPoint> rejected;

  Scene() {
    frame.colour = ColourImage(320, 240, std::vector<Bgr>(320U * 240U, kBlack));
    report.track.state = TrackingState::tracking;
  }
  void keep(float x_px, float y_px, bool mapped) {
    features.keypoints.push_back({x_px, y_px, 0, 10, 0});
    features.descriptors.push_back({});
    features.undistorted_px.emplace_back(x_px, y_px);
    features.depth_m.push_back(2);
    features.right_px.push_back(x_px - 10);
    report.points.push_back(mapped ? MapPointId{4, 1} : MapPointId{});
  }
  void reject(float x_px, float y_px, Rule rule) {
    rejected.push_back({{x_px, y_px, 0, 10, 0}, 2, rule});
  }
  ColourImage draw() {
    report.filtered = std::make_shared<const FilteredFeatures>(
        FilteredFeatures{std::make_shared<const Features>(features), rejected});
    return annotate(frame, report, ObjectCatalogue::defaults());
  }
};

TEST(Annotate, KeptPointsAreGreenThoseOutsideTheMapDark) {
  Scene scene;
  scene.keep(250, 100, true);
  scene.keep(280, 100, false);
  const ColourImage picture = scene.draw();
  EXPECT_EQ(picture(250, 100), (Bgr{0, 255, 0}));
  EXPECT_EQ(picture(280, 100), (Bgr{0, 120, 0}));
  EXPECT_EQ(picture(265, 100), kBlack);
}

TEST(Annotate, RejectedPointsAreRingsInTheColourOfTheirRule) {
  Scene scene;
  for (int i = 1; i < kRuleCount; ++i) {
    scene.reject(200.0F + 7.0F * static_cast<float>(i), 60, static_cast<Rule>(i));
  }
  const ColourImage picture = scene.draw();
  for (int i = 1; i < kRuleCount; ++i) {
    const Bgr expected = colour_of(static_cast<Rule>(i));
    EXPECT_EQ(picture(200 + 7 * i, 60), kBlack) << "centre of rule " << i;
    const Bgr ring = picture(202 + 7 * i, 60);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(ring[c], expected[c], 40) << "rule " << i;
  }
}

TEST(Annotate, EveryRuleHasAColourOfItsOwnThatCanBeSeen) {
  std::set<Bgr> colours;
  for (int i = 0; i < kRuleCount; ++i) {
    const Bgr colour = colour_of(static_cast<Rule>(i));
    EXPECT_TRUE(colours.insert(colour).second) << "rule " << i;
    EXPECT_GE(*std::max_element(colour.begin(), colour.end()), 128) << "rule " << i;
  }
}

/// Pixels of a column range at the bottom left that are not black.
int lit(const ColourImage& picture, int y0, int y1) {
  int n = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = 0; x < 150; ++x) n += picture(x, y) != kBlack ? 1 : 0;
  }
  return n;
}

TEST(Annotate, ALegendNamesTheRulesThatOccur) {
  Scene scene;
  EXPECT_EQ(lit(scene.draw(), 180, 240), 0);
  scene.reject(250, 60, Rule::edge);
  const ColourImage one = scene.draw();
  EXPECT_EQ(one(10, 240 - 12), colour_of(Rule::edge));
  EXPECT_EQ(lit(one, 180, 218), 0);
  scene.reject(260, 60, Rule::body_depth);
  const ColourImage two = scene.draw();
  EXPECT_EQ(two(10, 240 - 12), colour_of(Rule::edge));
  EXPECT_EQ(two(10, 240 - 26), colour_of(Rule::body_depth));
}

TEST(Annotate, TheMapGoesIntoACornerIfItFits) {
  Scene scene;
  scene.draw();
  const ColourImage map(60, 40, std::vector<Bgr>(60U * 40U, Bgr{200, 0, 0}));
  const auto catalogue = ObjectCatalogue::defaults();
  const ColourImage with = annotate(scene.frame, scene.report, catalogue, {0, map});
  EXPECT_GT(with(320 - 38, 44)[0], 150);
  EXPECT_EQ(with(320 - 75, 44), kBlack);
  const ColourImage large(400, 40, std::vector<Bgr>(400U * 40U, Bgr{200, 0, 0}));
  EXPECT_EQ(annotate(scene.frame, scene.report, catalogue, {0, large})(282, 44), kBlack);
}

TEST(Annotate, ShowsBoxesAndLeavesTheFrameAlone) {
  Scene scene;
  scene.report.detections = {{"person", 0.9F, {200, 80, 260, 160}}};
  const ColourImage picture = scene.draw();
  EXPECT_NE(picture(200, 120), kBlack);
  EXPECT_EQ(scene.frame.colour(200, 120), kBlack);
  EXPECT_EQ(picture.width(), 320);
  EXPECT_EQ(picture.height(), 240);
}

/// Pixels of a rectangle whose strongest channel is `channel` (of blue, green, red) and bright.
int coloured(const ColourImage& picture, const Box& box, std::size_t channel) {
  int n = 0;
  for (int y = static_cast<int>(box.y0); y < static_cast<int>(box.y1); ++y) {
    for (int x = static_cast<int>(box.x0); x < static_cast<int>(box.x1); ++x) {
      const Bgr pixel = picture(x, y);
      const auto others = std::max(pixel[(channel + 1) % 3], pixel[(channel + 2) % 3]);
      n += pixel[channel] > 150 && pixel[channel] > 2 * others ? 1 : 0;
    }
  }
  return n;
}

ObjectJudgement object_with(std::optional<float> log_odds, Rule rule) {
  ObjectJudgement object;
  object.box = {150, 80, 300, 180};
  object.rule = rule;
  object.log_odds = log_odds;
  return object;
}

TEST(Annotate, TellsInAnObjectsCornerWhetherItMoves) {
  const Box corner{150, 80, 280, 96}, below{150, 96, 280, 112}, rest{0, 112, 320, 240};
  Scene scene;
  scene.report.judgement.objects = {object_with(std::nullopt, Rule::body_depth)};
  EXPECT_EQ(coloured(scene.draw(), corner, 2), 0);
  scene.report.judgement.objects = {object_with(2.0F, Rule::body_depth)};
  EXPECT_GT(coloured(scene.draw(), corner, 2), 30);
  EXPECT_EQ(coloured(scene.draw(), corner, 1), 0);
  scene.report.judgement.objects.push_back(object_with(-3.5F, Rule::kept));
  const ColourImage both = scene.draw();
  EXPECT_GT(coloured(both, corner, 2), 30);
  EXPECT_EQ(coloured(both, corner, 1), 0);
  EXPECT_GT(coloured(both, below, 1), 30) << "of two in one place the second stands below";
  EXPECT_EQ(coloured(both, rest, 1) + coloured(both, rest, 2), 0);
}

TEST(Annotate, TintsSurfacesThatMove) {
  Scene scene;
  MotionOdds odds;
  odds.depth.grid = CellGrid(320, 240, 8);
  odds.log_odds.assign(static_cast<std::size_t>(odds.depth.grid.cells()), 0.0F);
  odds.moves.assign(odds.log_odds.size(), 0);
  odds.moves[static_cast<std::size_t>(odds.depth.grid.index(25, 12))] = 1;
  scene.report.odds = std::make_shared<const MotionOdds>(odds);
  const ColourImage picture = scene.draw();
  const Bgr tint = colour_of(Rule::seen_moving);
  for (const int px : {0, 7}) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(picture(200 + px, 96 + px)[c], 0.3 * tint[c], 1);
    }
  }
  EXPECT_EQ(picture(199, 100), kBlack);
  EXPECT_EQ(picture(208, 100), kBlack);
  EXPECT_EQ(scene.frame.colour(200, 96), kBlack);
  scene.report.odds = std::make_shared<const MotionOdds>();
  EXPECT_EQ(scene.draw()(200, 96), kBlack) << "nothing is known yet";
}

TEST(Annotate, PointsAtAndBeyondTheBorderAreCutOff) {
  Scene scene;
  scene.keep(0, 239, true);
  scene.keep(319.4F, 0, true);
  scene.reject(400, 300, Rule::box);
  EXPECT_EQ(scene.draw()(319, 0), (Bgr{0, 255, 0}));
}

}  // namespace
}  // namespace ydd
