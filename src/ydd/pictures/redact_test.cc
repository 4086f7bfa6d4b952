// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/redact.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr Bgr kWhite = {255, 255, 255};
constexpr Bgr kBlack = {0, 0, 0};

RgbdFrame white_frame() {
  constexpr std::size_t kCount = std::size_t{kWidth} * kHeight;
  RgbdFrame frame;
  frame.index = 7;
  frame.grey = GreyImage(kWidth, kHeight, std::vector<std::uint8_t>(kCount, 255));
  frame.colour = ColourImage(kWidth, kHeight, std::vector<Bgr>(kCount, kWhite));
  frame.depth_m = DepthImage(kWidth, kHeight, std::vector<float>(kCount, 2.0F));
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
    EXPECT_EQ(shown.colour(x, y), kBlack) << x;
    EXPECT_EQ(shown.grey(x, y), 0) << x;
    EXPECT_EQ(shown.depth_m(x, y), 0.0F) << x;
  }
  for (const auto& [x, y] : {std::pair{30, 180}, {70, 150}, {200, 30}, {0, 0}}) {
    EXPECT_EQ(shown.colour(x, y), kWhite) << x;
    EXPECT_EQ(shown.depth_m(x, y), 2.0F) << x;
  }
}

TEST(Redact, AlsoWhomTheDetectorMissedAndWhatSeemsToMove) {
  FrameReport report;
  report.judgement.regions.push_back(
      {-1, Rule::bridged, {100, 100, 140, 200}, DepthRange{1.0F, 1.5F}, 3});
  MotionOdds odds;
  odds.depth.grid = CellGrid(kWidth, kHeight, 8);
  odds.moves.assign(static_cast<std::size_t>(odds.depth.grid.cells()), 0);
  odds.moves[static_cast<std::size_t>(odds.depth.grid.index(30, 5))] = 1;
  report.odds = std::make_shared<const MotionOdds>(odds);
  const RgbdFrame shown = redacted(white_frame(), report, ObjectCatalogue::defaults());
  EXPECT_EQ(shown.colour(120, 150), kBlack);
  EXPECT_EQ(shown.colour(244, 44), kBlack);
  EXPECT_EQ(shown.colour(200, 150), kWhite);
}

TEST(Redact, NobodyIsInAFrameOfNoPixels) {
  FrameReport report;
  report.detections = {{"person", 1, {100, 100, 140, 200}}};
  EXPECT_TRUE(redacted(RgbdFrame{}, report, ObjectCatalogue::defaults()).colour.empty());
}

}  // namespace
}  // namespace ydd
