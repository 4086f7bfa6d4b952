// SPDX-License-Identifier: Apache-2.0
//
// Maps that outlive the system that made them.
#include <unistd.h>

#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/map/map_dump.h"
#include "ydd/map_files/map_file.h"
#include "ydd/system/merge_maps.h"
#include "ydd/system/picture_testing.h"
#include "ydd/system/slam_system.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using testing_world::Wall;

constexpr int kLastingFrames = 60;
constexpr double kArrival_s = 0.3;  // of 1 s that the rest of the walk takes

SystemOptions lasting_options(bool deterministic) {
  SystemOptions options;
  options.deterministic = deterministic;
  options.dynamics.variant = Variant::off;
  options.dynamics.compensation.points = 500;
  options.tracking.arrival.duration_s = kArrival_s;
  return options;
}

class LastingMap : public testing::TestWithParam<bool> {
 protected:
  std::unique_ptr<SlamSystem> start(std::optional<Atlas> map = std::nullopt) {
    return std::make_unique<SlamSystem>(wall_.camera(), options_, ObjectCatalogue::defaults(),
                                        nullptr, std::move(map));
  }
  /// Frames `from` to before `to`; gives how many were tracked.
  int feed(SlamSystem& system, int from, int to) {
    int tracked = 0;
    for (int i = from; i < to; ++i) {
      const Result<FrameReport> report = system.process(wall_.frame(i));
      EXPECT_TRUE(report.ok());
      tracked += report->track.state == TrackingState::tracking ? 1 : 0;
    }
    return tracked;
  }
  double error_m(const StampedPose& pose, int frame) const {
    return (wall_.T_world_camera(frame).inverse() * pose.T_world_camera).translation().norm();
  }

  Wall wall_{kLastingFrames};
  SystemOptions options_ = lasting_options(GetParam());
  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path();
};

INSTANTIATE_TEST_SUITE_P(Both, LastingMap, testing::Values(true, false), [](const auto& test) {
  return std::string(test.param ? "Inline" : "Threaded");
});

TEST_P(LastingMap, IsSavedAndGoneOnWith) {
  {
    const auto system = start();
    feed(*system, 0, 30);
    EXPECT_TRUE(system->finish());
    ASSERT_TRUE(system->save_map(folder_ / "a.map").ok());
    EXPECT_EQ(dump_map(load_map(folder_ / "a.map").value()), dump_map(*system->atlas()));
  }
  const auto system = start(load_map(folder_ / "a.map").value());
  const std::size_t keyframes = system->atlas()->keyframes().size();
  constexpr int kArrived = 29 + 8;  // within kArrival_s, nothing is added
  EXPECT_EQ(feed(*system, 29, kArrived), kArrived - 29);
  EXPECT_EQ(system->atlas()->keyframes().size(), keyframes);
  EXPECT_EQ(feed(*system, kArrived, kLastingFrames), kLastingFrames - kArrived);
  EXPECT_TRUE(system->finish());
  EXPECT_GT(system->atlas()->keyframes().size(), keyframes);
  EXPECT_EQ(system->atlas()->maps(), 1U);
  EXPECT_TRUE(system->atlas()->check_consistency().empty());
  const StampedPoses trajectory = system->trajectory();
  ASSERT_EQ(trajectory.size(), static_cast<std::size_t>(kLastingFrames - 29));
  EXPECT_LT(error_m(trajectory.back(), kLastingFrames - 1), 0.03);  // in the world of the first run
}

TEST_P(LastingMap, LocalizationOnlyChangesNothingUntilItIsSwitchedOff) {
  const auto first = start();
  feed(*first, 0, 40);
  EXPECT_TRUE(first->finish());
  ASSERT_TRUE(first->save_map(folder_ / "a.map").ok());
  const auto system = start(load_map(folder_ / "a.map").value());
  system->set_localization_only(true);
  const std::string before = dump_map(*system->atlas());
  EXPECT_EQ(feed(*system, 5, 35), 30);
  EXPECT_EQ(dump_map(*system->atlas()), before);
  system->set_localization_only(false);
  feed(*system, 35, kLastingFrames);
  EXPECT_TRUE(system->finish());
  EXPECT_NE(dump_map(*system->atlas()), before);
}

TEST_P(LastingMap, IsSavedWhileTheCameraMoves) {
  options_.map.autosave_s = 0.01;
  const auto system = start();
  const fs::path file = folder_ / "a.map";
  ASSERT_TRUE(system->autosave_to(file).ok());
  int seen = 0;
  for (int i = 0; i < kLastingFrames; ++i) {
    feed(*system, i, i + 1);
    if (!fs::exists(file)) continue;
    const Result<Atlas> held = load_map(file);
    ASSERT_TRUE(held.ok()) << held.error().message;
    ++seen;
  }
  EXPECT_GT(seen, 0);
  EXPECT_TRUE(system->finish());
  ASSERT_TRUE(system->save_map(file).ok());
  EXPECT_EQ(dump_map(load_map(file).value()), dump_map(*system->atlas()));
  const StageTimes times = system->save_times();
  ASSERT_GE(times.size(), 2U);
  EXPECT_EQ(times.front().stage, "save_whole");
  EXPECT_EQ(times.back().stage, "save_changes");
}

TEST_P(LastingMap, WhatIsNoMapIsNotOverwritten) {
  const fs::path file = folder_ / "a.map";
  ASSERT_TRUE(write_file_atomically(file, "minutes of the last meeting").ok());
  const auto system = start();
  EXPECT_FALSE(system->autosave_to(file).ok());
  EXPECT_FALSE(system->save_map(file).ok());
  EXPECT_EQ(read_file(file).value(), "minutes of the last meeting");
}

TEST_P(LastingMap, AMapOfAnotherCameraIsABrokenPromise) {
  Camera other = wall_.camera();
  other.fx_px += 20;  // a recalibrated one differs by less
  EXPECT_THROW(start(Atlas(other, PyramidScales::make(8, 1.2))), std::logic_error);
}

TEST_P(LastingMap, TwoOfOnePlaceAreMerged) {
  const auto run = [&](int from, int to) {
    const auto system = start();
    feed(*system, from, to);
    EXPECT_TRUE(system->finish());
    const auto saved = ydd::save_map(*system->atlas(), folder_ / "x.map", Replacing::anything);
    EXPECT_TRUE(saved.ok()) << saved.error().message;
    return load_map(folder_ / "x.map").value();
  };
  const Atlas a = run(0, 45);
  const Atlas b = run(20, kLastingFrames);
  LoopOptions loop;
  loop.min_score_ratio = 0.5;
  const Result<MergedMaps> merged = merge_maps(a, b, MapperOptions(), loop);
  ASSERT_TRUE(merged.ok());
  ASSERT_EQ(merged->merges.size(), 1U);
  EXPECT_EQ(merged->separate, 0);
  EXPECT_TRUE(merged->atlas.check_consistency().empty());
  // Its first keyframe stood at the origin of a world of its own.
  const KeyFrameId moved{a.keyframes().slots(), 1};
  const SE3 placed = merged->atlas.T_world_keyframe(moved).value();
  EXPECT_LT((placed.translation() - wall_.T_world_camera(20).translation()).norm(), 0.03);
}

TEST_P(LastingMap, TwoOfDifferentPlacesStayApart) {
  const auto run = [&](const Wall& wall) {
    SlamSystem system(wall.camera(), options_, ObjectCatalogue::defaults(), nullptr);
    for (int i = 0; i < 30; ++i) EXPECT_TRUE(system.process(wall.frame(i)).ok());
    EXPECT_TRUE(system.finish());
    EXPECT_TRUE(system.save_map(folder_ / "x.map").ok());
    return load_map(folder_ / "x.map").value();
  };
  const Atlas a = run(wall_);
  const Atlas b = run(Wall(kLastingFrames, 2, 99));
  const Result<MergedMaps> merged = merge_maps(a, b, MapperOptions(), LoopOptions());
  ASSERT_TRUE(merged.ok());
  EXPECT_TRUE(merged->merges.empty());
  EXPECT_EQ(merged->separate, 1);
  EXPECT_EQ(merged->atlas.keyframes().size(), a.keyframes().size() + b.keyframes().size());
}

}  // namespace
}  // namespace ydd
