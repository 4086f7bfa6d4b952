// SPDX-License-Identifier: Apache-2.0
#include "ydd/live/live_run.h"

#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/temporary_folder_testing.h"
#include "ydd/system/picture_testing.h"

namespace ydd {
namespace {

using testing_world::Wall;

SystemOptions quick_options() {
  SystemOptions options;
  options.deterministic = true;
  options.dynamics.compensation.points = 300;
  return options;
}

/// A run over the wall, one call per frame, as the application's loop does it.
struct WallRun {
  static LiveScene scene(const std::filesystem::path& map_file) {
    LiveScene out;
    out.map_file = map_file;
    return out;
  }

  explicit WallRun(const std::filesystem::path& map_file = {}) : control(scene(map_file)) {}

  Wall wall{60};
  LiveControl control;
  SlamSystem system{wall.camera(), quick_options(), ObjectCatalogue::defaults(), nullptr};
  LiveRun live{control, system};
  int next = 0;

  /// False when the run should end.
  bool one_frame() {
    if (!live.ready_for_frame()) return false;
    const RgbdFrame frame = wall.frame(next++);
    live.publish(frame, system.process(frame).value());
    return true;
  }
  void frames(int count) {
    for (int i = 0; i < count; ++i) ASSERT_TRUE(one_frame());
  }
};

TEST(LiveRun, PublishesEachFrameWithMapAndHistory) {
  WallRun run;
  EXPECT_EQ(run.control.newest(), nullptr);
  run.frames(3);
  const auto live = run.control.newest();
  ASSERT_NE(live, nullptr);
  EXPECT_EQ(live->report->index, 2);
  EXPECT_EQ(live->frame.index, 2);
  EXPECT_EQ(live->atlas, run.system.atlas());
  EXPECT_GT(live->atlas->points().size(), 50U);
  EXPECT_EQ(live->history->size(), 3U);
  live->history->for_each([&](auto, const LiveSample& sample) {
    EXPECT_EQ(sample.state, TrackingState::tracking);
    EXPECT_TRUE(live->atlas->T_world_keyframe(sample.reference).has_value());
    EXPECT_GT(sample.kept, 50);
    EXPECT_GT(sample.total_ms, 0);
  });
  EXPECT_FALSE(live->status.paused);
  EXPECT_GT(live->status.frames_per_second, 0);
  EXPECT_THAT(run.live.interventions(), testing::IsEmpty());
}

TEST(LiveRun, WhatAWatcherHoldsDoesNotChange) {
  WallRun run;
  run.frames(2);
  const auto held = run.control.newest();
  run.frames(2);
  EXPECT_EQ(held->history->size(), 2U);
  EXPECT_EQ(held->report->index, 1);
  EXPECT_GT(run.control.newest()->serial, held->serial);
}

TEST(LiveRun, PausedItWaitsStepsOneFrameAndGoesOn) {
  WallRun run;
  run.frames(1);
  run.control.send(live::Step{});  // a step pauses, too
  run.frames(1);
  std::jthread user([&] {
    while (!run.control.newest()->status.paused) std::this_thread::yield();
    run.control.send(live::Step{});
    while (run.control.newest()->report->index < 2) std::this_thread::yield();
    EXPECT_TRUE(run.control.newest()->status.paused);
    EXPECT_EQ(run.control.newest()->status.frames_per_second, 0);
    run.control.send(live::Resume{});
  });
  run.frames(3);
  user.join();
  EXPECT_EQ(run.control.newest()->report->index, 4);
  EXPECT_FALSE(run.control.newest()->status.paused);
}

TEST(LiveRun, QuitEndsItAlsoWhilePaused) {
  WallRun run;
  run.frames(2);
  run.control.send(live::Pause{});
  run.control.send(live::Quit{});
  EXPECT_FALSE(run.one_frame());
  EXPECT_EQ(run.next, 2);
}

TEST(LiveRun, LocalisationOnlyKeepsTheMapUntilItIsSwitchedOff) {
  WallRun run;
  run.frames(3);
  run.control.send(live::SetLocalizationOnly{true});
  run.frames(1);
  const auto before = run.control.newest();
  EXPECT_TRUE(before->status.localization_only);
  run.frames(30);
  EXPECT_EQ(run.control.newest()->atlas->keyframes().size(), before->atlas->keyframes().size());
  run.control.send(live::SetLocalizationOnly{false});
  run.frames(25);
  EXPECT_FALSE(run.control.newest()->status.localization_only);
  EXPECT_GT(run.control.newest()->atlas->keyframes().size(), before->atlas->keyframes().size());
}

TEST(LiveRun, SavesTheMapOrTellsWhyNot) {
  const TemporaryFolder folder;
  {
    WallRun run(folder / "map.ydd");
    run.frames(3);
    run.control.send(live::SaveMap{});
    run.frames(1);
    EXPECT_THAT(run.control.newest()->status.message, testing::HasSubstr("map saved to"));
    EXPECT_TRUE(std::filesystem::exists(folder / "map.ydd"));
  }
  WallRun nowhere(folder / "none/map.ydd");
  nowhere.frames(1);
  nowhere.control.send(live::SaveMap{});
  nowhere.frames(1);
  EXPECT_THAT(nowhere.control.newest()->status.message, testing::HasSubstr("none/map.ydd"));
}

TEST(LiveRun, ResetStartsAfreshAndSaysSo) {
  WallRun run;
  run.frames(5);
  run.control.send(live::Reset{});
  run.frames(2);
  const auto live = run.control.newest();
  EXPECT_EQ(live->status.resets, 1);
  EXPECT_EQ(live->history->size(), 2U);
  EXPECT_EQ(live->report->track.state, TrackingState::tracking);
  EXPECT_TRUE(run.system.finish());
  ASSERT_EQ(run.system.trajectory().size(), 2U);
  EXPECT_LT(run.system.trajectory().front().T_world_camera.translation().norm(), 1e-9);
}

TEST(LiveRun, CommandsAreKeptForTheSummary) {
  WallRun run;
  run.control.send(live::SetVariant{Variant::box});
  run.frames(3);
  EXPECT_EQ(run.system.variant(), Variant::box);
  EXPECT_EQ(run.control.newest()->status.variant, Variant::box);
  run.control.send(live::Reset{});
  run.frames(1);
  EXPECT_EQ(run.system.variant(), Variant::box);  // reset keeps it
  const auto& all = run.live.interventions();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].after_frame, -1);
  EXPECT_EQ(all[0].command, "variant box");
  EXPECT_EQ(all[1].after_frame, 2);
  EXPECT_EQ(all[1].command, "reset");
}

TEST(LiveRun, FinishedItShowsTheFinalMapAndRefusesCommands) {
  WallRun run;
  run.frames(4);
  EXPECT_TRUE(run.system.finish());
  run.live.finish();
  EXPECT_TRUE(run.control.newest()->status.finished);
  EXPECT_EQ(run.control.newest()->atlas, run.system.atlas());
  EXPECT_EQ(run.control.end(), LiveEnd::ended);
  EXPECT_FALSE(run.control.send(live::Pause{}));
}

}  // namespace
}  // namespace ydd
