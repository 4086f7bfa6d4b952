// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/annotate.h"

#include <algorithm>
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

TEST(Annotate, PointsAtAndBeyondTheBorderAreCutOff) {
  Scene scene;
  scene.keep(0, 239, true);
  scene.keep(319.4F, 0, true);
  scene.reject(400, 300, Rule::box);
  EXPECT_EQ(scene.draw()(319, 0), (Bgr{0, 255, 0}));
}

}  // namespace
}  // namespace ydd
