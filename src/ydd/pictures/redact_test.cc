// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/redact.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

constexpr int kShownWidth_px = 320;
constexpr int kShownHeight_px = 240;
constexpr Bgr kShown = {255, 255, 255};
constexpr Bgr kHidden = {0, 0, 0};

RgbdFrame white_frame() {
  constexpr std::size_t kCount = std::size_t{kShownWidth_px} * kShownHeight_px;
  RgbdFrame frame;
  frame.index = 7;
  frame.grey = GreyImage(kShownWidth_px, kShownHeight_px, std::vector<std::uint8_t>(kCount, 255));
  frame.colour = ColourImage(kShownWidth_px, kShownHeight_px, std::vector<Bgr>(kCount, kShown));
  frame.depth_m = DepthImage(kShownWidth_px, kShownHeight_px, std::vector<float>(kCount, 2.0F));
  return frame;
}

TEST(Redact, BlacksOutPersonsHeadsAndHandsButNoChair) {
  FrameReport report;
  report.detections = {{"person", 1, {100, 100, 140, 200}},
                       {"head", 1, {250, 20, 270, 40}},
                       {"chair", 1, {10, 150, 60, 220}},
                       {"person", 1, {300, 200, 320, 240}}};  // at the border
  const RgbdFrame shown = redacted(white_frame(), report, ObjectCatalogue::defaults());
  EXPECT_EQ(shown.index, 7);
  for (const auto& [x, y] : {std::pair{120, 150}, {95, 150}, {260, 30}, {319, 239}}) {
    EXPECT_EQ(shown.colour(x, y), kHidden) << x;
    EXPECT_EQ(shown.grey(x, y), 0) << x;
    EXPECT_EQ(shown.depth_m(x, y), 0.0F) << x;
  }
  for (const auto& [x, y] : {std::pair{30, 180}, {70, 150}, {200, 30}, {0, 0}}) {
    EXPECT_EQ(shown.colour(x, y), kShown) << x;
    EXPECT_EQ(shown.depth_m(x, y), 2.0F) << x;
  }
}

TEST(Redact, AlsoWhomTheDetectorMissedAndWhatSeemsToMove) {
  FrameReport report;
  report.judgement.regions.push_back(
      {-1, Rule::bridged, {100, 100, 140, 200}, DepthRange{1.0F, 1.5F}, 3});
  MotionOdds odds;
  odds.depth.grid = CellGrid(kShownWidth_px, kShownHeight_px, 8);
  odds.moves.assign(static_cast<std::size_t>(odds.depth.grid.cells()), 0);
  odds.moves[static_cast<std::size_t>(odds.depth.grid.index(30, 5))] = 1;
  report.odds = std::make_shared<const MotionOdds>(odds);
  const RgbdFrame shown = redacted(white_frame(), report, ObjectCatalogue::defaults());
  EXPECT_EQ(shown.colour(120, 150), kHidden);
  EXPECT_EQ(shown.colour(244, 44), kHidden);
  EXPECT_EQ(shown.colour(200, 150), kShown);
}

TEST(Redact, NobodyIsInAFrameOfNoPixels) {
  FrameReport report;
  report.detections = {{"person", 1, {100, 100, 140, 200}}};
  EXPECT_TRUE(redacted(RgbdFrame{}, report, ObjectCatalogue::defaults()).colour.empty());
}

}  // namespace
}  // namespace ydd
