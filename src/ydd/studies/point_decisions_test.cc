// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/point_decisions.h"

#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/simulation/simulator.h"
#include "ydd/simulation/tum_writer.h"
#include "ydd/studies/simulated_run.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;

/// A few frames of a busy room, with masks and exact boxes.
class PointDecisionsOf : public testing::Test {
 protected:
  void SetUp() override {
    world_.width_px = 320;
    world_.height_px = 240;
    world_.frames = 6;
    world_.busy = true;
    folder_ = fs::temp_directory_path() / fmt::format("ydd_decisions_{}", ::getpid());
    ASSERT_TRUE(write_tum_sequence(Simulator(world_), folder_, {}).ok());
  }
  void TearDown() override { fs::remove_all(folder_); }

  PointDecisions decide(Variant variant, int latency_frames = 0) const {
    SystemOptions options;
    options.dynamics.variant = variant;
    auto decisions = decide_points(folder_, folder_ / "detections.jsonl", options, latency_frames);
    EXPECT_TRUE(decisions.ok()) << decisions.error().message;
    return decisions ? *decisions : PointDecisions();
  }

  WorldOptions world_;
  fs::path folder_;
};

TEST_F(PointDecisionsOf, ABusyRoomBeatItsBoxes) {
  const PointDecisions off = decide(Variant::off);
  EXPECT_EQ(off.judge_ms.size(), 6U);
  EXPECT_GT(off.quality.moving, 50);
  EXPECT_EQ(off.quality.recall(), 0.0);
  const PointDecisions box = decide(Variant::box), full = decide(Variant::full);
  EXPECT_GT(full.quality.recall(), 0.9);
  EXPECT_GT(full.quality.precision(), box.quality.precision());
  EXPECT_GT(decide(Variant::evidence).quality.recall(), 0.8);
}

TEST_F(PointDecisionsOf, EvidenceNeedsNoBoxes) {
  const auto blind = [&](Variant variant) {
    SystemOptions options;
    options.dynamics.variant = variant;
    const auto decisions = decide_points(folder_, {}, options, 0);
    EXPECT_TRUE(decisions.ok()) << decisions.error().message;
    return decisions ? decisions->quality : PointQuality();
  };
  EXPECT_EQ(blind(Variant::full).recall(), 0.0);
  EXPECT_GT(blind(Variant::evidence).recall(), 0.3);
  EXPECT_GT(blind(Variant::evidence).precision(), 0.5);
}

TEST_F(PointDecisionsOf, LateBoxesAreWorseButNotUseless) {
  const double late = decide(Variant::full, 3).quality.recall();
  EXPECT_GT(late, 0.6);
  EXPECT_LE(late, decide(Variant::full).quality.recall());
}

TEST_F(PointDecisionsOf, ASequenceWithoutMasksFails) {
  fs::remove_all(folder_ / "mask");
  const auto decisions = decide_points(folder_, folder_ / "detections.jsonl", SystemOptions(), 0);
  ASSERT_FALSE(decisions.ok());
  EXPECT_THAT(decisions.error().message, testing::HasSubstr("mask"));
}

TEST(SimulatedRun, IsHeldAgainstTheTruth) {
  WorldOptions world;
  world.width_px = 320;
  world.height_px = 240;
  world.frames = 20;
  SystemOptions options;
  options.deterministic = true;
  int steps = 0;
  const auto run =
      run_simulated(Simulator(world), options, {}, [&](int, const SimulatedStep&) { ++steps; });
  ASSERT_TRUE(run.ok()) << run.error().message;
  EXPECT_EQ(steps, 20);
  EXPECT_EQ(run->lost_frames(), 0);
  EXPECT_GE(run->ate_m(), 0.0);
  EXPECT_LT(run->ate_m(), 0.02);
}

}  // namespace
}  // namespace ydd
