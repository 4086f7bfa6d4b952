// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/motion_evidence.h"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/evidence/evidence_testing.h"

namespace ydd {
namespace {

using testing::Each;

Camera evidence_camera() { return evidence_testing::centred_camera(320, 240, 260); }

/// A camera that stands before a wall at 2 m with features on it.
class WallWatch {
 public:
  WallWatch() : evidence_(cells_of_8_px(), evidence_camera()) {}

  /// The next frame at 30 Hz; with a bare box at 1.2 m in the middle of the view, or nearer.
  const MotionOdds& look(bool box, float nearer_m = 0) {
    std::vector<float> pixels(std::size_t{320} * 240, 2.0F);
    for (int y = 80; y < 160 && box; ++y) {
      for (int x = 120; x < 200; ++x)
        pixels[320 * static_cast<std::size_t>(y) + static_cast<std::size_t>(x)] = 1.2F - nearer_m;
    }
    const DepthImage depth_m(320, 240, std::move(pixels));
    const Timestamp stamp{33'333'333 * ++frames_};
    return evidence_.look(std::make_shared<const Features>(features(depth_m)), depth_m, stamp);
  }
  void watch(int frames, bool box) {
    for (int k = 0; k < frames; ++k) {
      look(box);
      evidence_.settle(SE3(), {});
    }
  }
  MotionEvidence& evidence() { return evidence_; }
  std::size_t middle() const {
    return static_cast<std::size_t>(CellGrid(320, 240, 8).index(20, 15));
  }
  std::size_t corner() const { return static_cast<std::size_t>(CellGrid(320, 240, 8).index(4, 4)); }

 private:
  static EvidenceOptions cells_of_8_px() {
    EvidenceOptions options;
    options.cell_px = 16;  // at 640 px width
    return options;
  }
  static Features features(const DepthImage& depth_m) {
    std::mt19937 random(11);
    OrbFeatures orb;
    for (int y = 12; y < 236; y += 16) {
      for (int x = 12; x < 316; x += 16) {
        Descriptor descriptor{};
        for (std::uint64_t& word : descriptor) {
          const std::uint64_t upper = random();
          word = (upper << 32U) | random();
        }
        if (depth_m(x, y) < 2.0F) continue;
        orb.keypoints.push_back({static_cast<float>(x), static_cast<float>(y), 0, 1, 0});
        orb.descriptors.push_back(descriptor);
      }
    }
    return with_geometry(std::move(orb), evidence_camera(), depth_m);
  }

  MotionEvidence evidence_;
  std::int64_t frames_ = 0;
};

void expect_nothing_known(const MotionOdds& odds) {
  EXPECT_EQ(odds.log_odds.size(), 1200U);
  EXPECT_THAT(odds.log_odds, Each(0.0F));
  EXPECT_THAT(odds.moves, Each(0));
  EXPECT_TRUE(odds.prior.empty());
}

TEST(MotionEvidence, KnowsNothingOfTheFirstFrame) {
  WallWatch wall;
  EXPECT_TRUE(wall.evidence().odds().empty());
  expect_nothing_known(wall.look(false));
}

TEST(MotionEvidence, AStandingWallStandsStill) {
  WallWatch wall;
  wall.watch(40, false);
  for (const float log_odds : wall.evidence().odds().log_odds) EXPECT_LT(log_odds, -0.5F);
  for (const float calm_s : wall.evidence().odds().calm_s) EXPECT_GT(calm_s, 1.0F);
}

TEST(MotionEvidence, WhatComesBeforeTheWallMoves) {
  WallWatch wall;
  wall.watch(40, false);
  const MotionOdds& odds = wall.look(true);
  EXPECT_GT(odds.log_odds[wall.middle()], 1.0F);
  EXPECT_EQ(odds.moves[wall.middle()], 1);
  EXPECT_EQ(odds.calm_s[wall.middle()], 0.0F);
  EXPECT_LT(odds.log_odds[wall.corner()], 0.0F);
  EXPECT_EQ(odds.moves[wall.corner()], 0);
}

TEST(MotionEvidence, WhatHasComeAndStaysComesToRest) {
  WallWatch wall;
  wall.watch(40, false);
  wall.watch(150, true);
  EXPECT_EQ(wall.evidence().odds().moves[wall.middle()], 0);
  EXPECT_LT(wall.evidence().odds().log_odds[wall.middle()], 0.0F);
}

TEST(MotionEvidence, ACalmEndsAtOnceWhateverTheOddsWere) {
  WallWatch wall;
  wall.watch(40, false);
  wall.watch(150, true);
  ASSERT_GT(wall.evidence().odds().calm_s[wall.middle()], 1.0F);
  ASSERT_LT(wall.evidence().odds().log_odds[wall.middle()], -2.0F);
  const MotionOdds& odds = wall.look(true, 0.05F);
  EXPECT_LT(odds.log_odds[wall.middle()], 0.0F) << "one frame does not outweigh five seconds";
  EXPECT_EQ(odds.calm_s[wall.middle()], 0.0F);
  EXPECT_GT(odds.calm_s[wall.corner()], 1.0F);
}

TEST(MotionEvidence, AFrameThatIsDoubtedTellsNothing) {
  WallWatch wall;
  wall.watch(40, false);
  const std::vector<float> known = wall.evidence().odds().log_odds;
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(wall.look(true).moves[wall.middle()], 1) << k << ": it stays as new as it was";
    wall.evidence().withhold(SE3());
    EXPECT_EQ(wall.evidence().odds().log_odds, known);
  }
  EXPECT_THAT(wall.look(false).moves, Each(0));
}

TEST(MotionEvidence, FollowsTheCameraThroughDoubtedFrames) {
  WallWatch wall;
  wall.watch(40, false);
  const SE3 aside(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.02, 0, 0));
  for (const SE3& step : {aside, aside.inverse()}) {
    wall.look(false);
    wall.evidence().withhold(step);
  }
  EXPECT_THAT(wall.look(false).moves, Each(0));
  EXPECT_LT(wall.evidence().odds().log_odds[wall.corner()], -0.5F);
}

TEST(MotionEvidence, ADoubtedFirstFrameIsForgotten) {
  WallWatch wall;
  wall.look(true);
  wall.evidence().withhold(std::nullopt);
  EXPECT_TRUE(wall.evidence().odds().empty());
  expect_nothing_known(wall.look(false));
}

TEST(MotionEvidence, ClearForgets) {
  WallWatch wall;
  wall.watch(40, false);
  wall.watch(3, true);
  ASSERT_GT(wall.evidence().odds().log_odds[wall.middle()], 0.0F);
  wall.evidence().clear();
  EXPECT_TRUE(wall.evidence().odds().empty());
  wall.evidence().settle(SE3(), {});  // of nothing
  expect_nothing_known(wall.look(true));
}

TEST(MotionEvidence, ClearForgetsAFrameThatIsNotSettled) {
  WallWatch wall;
  wall.watch(10, false);
  wall.look(false);
  wall.evidence().clear();
  expect_nothing_known(wall.look(true));
}

TEST(MotionEvidence, GoesOnWhereNothingWasSettled) {
  WallWatch wall;
  EXPECT_NO_THROW({
    for (int k = 0; k < 40; ++k) wall.look(false);
  });
  EXPECT_LT(wall.evidence().odds().log_odds[wall.corner()], -1.0F);
  EXPECT_EQ(wall.look(true).moves[wall.middle()], 1);
}

TEST(MotionEvidence, DoesNotBelieveATrackThatTheRoomSpeaksAgainst) {
  WallWatch wall;
  wall.watch(40, false);
  const SE3 wrong(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.3, 0, 0.2));
  for (int k = 0; k < 3; ++k) {
    wall.look(false);
    wall.evidence().settle(wrong, {});
  }
  EXPECT_THAT(wall.look(false).moves, Each(0));
  EXPECT_LT(wall.evidence().odds().log_odds[wall.corner()], -1.0F);
}

TEST(MotionEvidence, KeepsWhatWasPresumedForTheNextFrame) {
  WallWatch wall;
  wall.watch(3, false);
  wall.look(false);
  wall.evidence().settle(SE3(), std::vector<float>(1200, 1.5F));
  EXPECT_THAT(wall.look(false).prior, Each(1.5F));
}

TEST(MotionEvidence, IsTheSameBitForBit) {
  WallWatch once, again;
  for (WallWatch* wall : {&once, &again}) {
    wall->watch(10, false);
    wall->watch(5, true);
  }
  EXPECT_EQ(once.evidence().odds().log_odds, again.evidence().odds().log_odds);
}

}  // namespace
}  // namespace ydd
