// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/motion_odds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/evidence/evidence_testing.h"

namespace ydd {
namespace {

using testing::Each;

/// A wall, with what is at `z_m` in columns [column0, column1).
CoarseDepth wall_and_strip(float wall_m, int column0 = 0, int column1 = 0, float z_m = 0) {
  std::vector<float> pixels(std::size_t{160} * 120, wall_m);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const int column = static_cast<int>(i % 160) / 8;
    if (column >= column0 && column < column1) pixels[i] = z_m;
  }
  return coarse_depth({160, 120, std::move(pixels)}, 8);
}

/// The log-odds of each cell are its column.
MotionOdds numbered(CoarseDepth depth) {
  MotionOdds odds;
  const CellGrid grid = depth.grid;
  odds.depth = std::move(depth);
  for (int i = 0; i < grid.cells(); ++i) {
    const int column = i % grid.columns;
    odds.log_odds.push_back(static_cast<float>(column + 1));
    odds.moves.push_back(column == 10);
    odds.calm_s.push_back(2.0F);
    odds.prior.push_back(0.5F);
  }
  return odds;
}

MotionOdds carried(const MotionOdds& before, CoarseDepth depth, const SE3& T_before_now) {
  const Camera camera = evidence_testing::small_camera();
  const std::vector<Eigen::Vector2f> rays = cell_rays(camera, depth.grid);
  return carried_odds(before, std::move(depth), T_before_now, camera, rays, {});
}

SE3 aside(double x_m) { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x_m, 0, 0)}; }

std::size_t odds_cell(int column, int row) { return static_cast<std::size_t>(row * 20 + column); }

TEST(CarriedOdds, FollowAStandingSurface) {
  const MotionOdds now = carried(numbered(wall_and_strip(2.0F)), wall_and_strip(2.0F), aside(0.2));
  for (int row = 0; row < 15; ++row) {
    for (int column = 0; column < 18; ++column) {
      const std::size_t i = odds_cell(column, row);
      EXPECT_EQ(now.log_odds[i], static_cast<float>(column + 3)) << column;
      EXPECT_EQ(now.moves[i], column == 8) << column;
      EXPECT_EQ(now.calm_s[i], 2.0F);
      EXPECT_EQ(now.prior[i], 0.5F);
    }
  }
}

TEST(CarriedOdds, KnowNothingOfWhatWasOutOfView) {
  const MotionOdds now = carried(numbered(wall_and_strip(2.0F)), wall_and_strip(2.0F), aside(0.2));
  for (const int column : {18, 19}) {
    const std::size_t i = odds_cell(column, 7);
    EXPECT_EQ(now.log_odds[i], 0.0F);
    EXPECT_EQ(now.moves[i], 0);
    EXPECT_LT(now.calm_s[i], 2.0F);
    EXPECT_EQ(now.prior[i], 0.0F);
  }
}

TEST(CarriedOdds, KnowNothingOfASurfaceAtAnotherDepth) {
  const MotionOdds now =
      carried(numbered(wall_and_strip(2.0F)), wall_and_strip(2.0F, 8, 12, 1.0F), SE3());
  EXPECT_EQ(now.log_odds[odds_cell(10, 7)], 0.0F);
  EXPECT_EQ(now.moves[odds_cell(10, 7)], 0);
  EXPECT_EQ(now.log_odds[odds_cell(13, 7)], 14.0F);
}

TEST(CarriedOdds, OfNothingAreNothing) {
  const MotionOdds now = carried({}, wall_and_strip(2.0F), SE3());
  EXPECT_EQ(now.log_odds.size(), 300U);
  EXPECT_THAT(now.log_odds, Each(0.0F));
  EXPECT_THAT(now.moves, Each(0));
  EXPECT_TRUE(now.prior.empty());
  EXPECT_FALSE(now.empty());
}

TEST(CellAt, TakesTheNeighbourWhoseDepthFits) {
  const MotionOdds odds = numbered(wall_and_strip(2.0F, 11, 20, 1.0F));
  EXPECT_EQ(odds.cell_at(86, 60, 2.0F), 7 * 20 + 10);
  EXPECT_EQ(odds.cell_at(86, 60, 1.0F) % 20, 11);
  EXPECT_EQ(odds.cell_at(90, 60, 2.0F) % 20, 10);
  EXPECT_EQ(odds.cell_at(86, 60, 0.0F), 7 * 20 + 10) << "no reading: its own";
  EXPECT_EQ(odds.cell_at(70, 60, 1.0F), 7 * 20 + 8) << "too far away";
}

TEST(CellAt, FindsNoneOutsideAndInHoles) {
  const MotionOdds odds = numbered(wall_and_strip(2.0F, 6, 14, 0.0F));
  EXPECT_EQ(odds.cell_at(-0.5F, 60, 2.0F), -1);
  EXPECT_EQ(odds.cell_at(60, -0.5F, 0.0F), -1);
  EXPECT_EQ(odds.cell_at(160, 60, 2.0F), -1);
  EXPECT_EQ(odds.cell_at(60, 120, 2.0F), -1);
  EXPECT_EQ(odds.cell_at(84, 60, 2.0F), -1);
  EXPECT_EQ(odds.cell_at(50, 60, 2.0F) % 20, 5) << "beside the hole";
}

TEST(Contradicts, WhatIsSeenThrough) {
  const MotionOdds odds = numbered(wall_and_strip(2.0F));
  EXPECT_TRUE(odds.contradicts(40, 60, 1.0F, 0.1F));
  EXPECT_FALSE(odds.contradicts(40, 60, 1.95F, 0.1F)) << "within the tolerance";
  EXPECT_FALSE(odds.contradicts(40, 60, 2.0F, 0.1F));
}

TEST(Contradicts, NotWhatIsHidden) {
  const MotionOdds odds = numbered(wall_and_strip(2.0F));
  EXPECT_FALSE(odds.contradicts(40, 60, 3.0F, 0.1F));
  EXPECT_FALSE(odds.contradicts(84, 60, 3.0F, 0.1F)) << "not even behind what moves";
}

TEST(Contradicts, WhatLiesOnAMover) {
  const MotionOdds odds = numbered(wall_and_strip(2.0F));  // column 10 moves
  EXPECT_TRUE(odds.contradicts(84, 60, 2.05F, 0.1F));
  EXPECT_FALSE(odds.contradicts(84, 60, 2.15F, 0.1F));
}

TEST(Contradicts, NothingNextToAnEdgeOrOutside) {
  const MotionOdds odds = numbered(wall_and_strip(2.0F, 0, 5, 1.0F));
  EXPECT_FALSE(odds.contradicts(41, 60, 1.0F, 0.1F)) << "the strip ends a pixel beside";
  EXPECT_TRUE(odds.contradicts(60, 60, 1.0F, 0.1F));
  EXPECT_FALSE(odds.contradicts(-3, 60, 1.0F, 0.1F));
  EXPECT_FALSE(numbered(wall_and_strip(0.0F)).contradicts(84, 60, 1.0F, 0.1F));
}

}  // namespace
}  // namespace ydd
