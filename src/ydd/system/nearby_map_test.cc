// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/nearby_map.h"

#include <sqlite3.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/temporary_folder_testing.h"
#include "ydd/map_files/map_file.h"
#include "ydd/system/picture_testing.h"
#include "ydd/system/slam_system.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using testing_world::Wall;

constexpr int kNearbyFrames = 150;
constexpr int kPixelsAFrame = 10;

SystemOptions nearby_options(bool deterministic) {
  SystemOptions options;
  options.deterministic = deterministic;
  options.dynamics.variant = Variant::off;
  options.dynamics.compensation.points = 400;
  options.map.pictures = false;
  return options;
}

/// What a run told of its frames.
struct Told {
  std::vector<TrackResult> tracked;
  StampedPoses trajectory;
  std::size_t most_in_memory = 0;  ///< keyframes
};

/// A map of a long wall in a file, made once for all tests.
class NearbyMapTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    temporary_ = std::make_unique<TemporaryFolder>();
    SlamSystem system(wall().camera(), nearby_options(true), ObjectCatalogue::defaults(), nullptr);
    for (int i = 0; i < kNearbyFrames; ++i) EXPECT_TRUE(system.process(wall().frame(i)).ok());
    EXPECT_TRUE(system.finish());
    keyframes_ = system.atlas()->keyframes().size();
    EXPECT_TRUE(system.save_map(file()).ok());
  }
  static void TearDownTestSuite() { temporary_.reset(); }

  static const Wall& wall() {
    static const Wall wall(kNearbyFrames, kPixelsAFrame);
    return wall;
  }
  static fs::path file() { return temporary_->path() / "wall.map"; }

  static NearbyOptions of_keyframes(std::size_t keyframes, bool in_background = false) {
    NearbyOptions options;
    options.keyframes = keyframes;
    options.in_background = in_background;
    return options;
  }
  static std::unique_ptr<SlamSystem> in_part(std::size_t keyframes, bool in_background = false) {
    auto map =
        NearbyMap::open(StoredMap::open(file()).value(), of_keyframes(keyframes, in_background));
    EXPECT_TRUE(map.ok());
    return std::make_unique<SlamSystem>(wall().camera(), nearby_options(!in_background),
                                        ObjectCatalogue::defaults(), nullptr, std::move(*map));
  }
  static std::unique_ptr<SlamSystem> whole() {
    auto system = std::make_unique<SlamSystem>(wall().camera(), nearby_options(true),
                                               ObjectCatalogue::defaults(), nullptr,
                                               load_map(file()).value());
    system->set_localization_only(true);
    return system;
  }
  static Told walk(SlamSystem& system, int from, int to, int step = 1) {
    Told told;
    for (int i = from; i < to; i += step) {
      const Result<FrameReport> report = system.process(wall().frame(i));
      EXPECT_TRUE(report.ok());
      EXPECT_FALSE(report->keyframe);
      told.tracked.push_back(report->track);
      told.most_in_memory = std::max(told.most_in_memory, system.atlas()->keyframes().size());
    }
    EXPECT_TRUE(system.finish());
    told.trajectory = system.trajectory();
    return told;
  }
  /// How far apart two walks are at most; all frames of both must be tracked.
  static double apart_m(const Told& a, const Told& b) {
    EXPECT_EQ(a.tracked.size(), b.tracked.size());
    EXPECT_EQ(a.trajectory.size(), b.trajectory.size());
    double apart_m = 0;
    for (std::size_t i = 0; i < a.trajectory.size() && i < b.trajectory.size(); ++i) {
      apart_m = std::max(apart_m, (a.trajectory[i].T_world_camera.translation() -
                                   b.trajectory[i].T_world_camera.translation())
                                      .norm());
    }
    return apart_m;
  }

  static std::unique_ptr<TemporaryFolder> temporary_;
  static std::size_t keyframes_;
};
std::unique_ptr<TemporaryFolder> NearbyMapTest::temporary_;
std::size_t NearbyMapTest::keyframes_ = 0;

TEST_F(NearbyMapTest, WithAllOfTheMapNearTheRunIsThatOfTheWholeMap) {
  const auto a = whole();
  const auto b = in_part(4 * keyframes_);
  const Told wholly = walk(*a, 40, 100);
  const Told nearby = walk(*b, 40, 100);
  EXPECT_EQ(nearby.most_in_memory, keyframes_);
  ASSERT_EQ(wholly.trajectory.size(), 60U);
  EXPECT_EQ(apart_m(wholly, nearby), 0.0);
  for (std::size_t i = 0; i < wholly.tracked.size(); ++i) {
    EXPECT_EQ(wholly.tracked[i].points, nearby.tracked[i].points);
    EXPECT_EQ(wholly.tracked[i].reference, nearby.tracked[i].reference);
  }
}

TEST_F(NearbyMapTest, WithAPartOfItTheCameraIsFoundAndFollowedAllTheSame) {
  const std::size_t bound = keyframes_ / 2;
  const auto a = whole();
  const auto b = in_part(bound);
  const auto c = in_part(bound);
  const Told wholly = walk(*a, 5, kNearbyFrames);
  const Told nearby = walk(*b, 5, kNearbyFrames);
  const Told again = walk(*c, 5, kNearbyFrames);
  EXPECT_LE(nearby.most_in_memory, bound + bound / 8 + 1);
  EXPECT_EQ(nearby.trajectory.size(), static_cast<std::size_t>(kNearbyFrames - 5));
  // Half of the map is less than the 80 keyframes that a local map may have: 1.4 mm were measured.
  EXPECT_LT(apart_m(wholly, nearby), 0.004);
  EXPECT_EQ(apart_m(nearby, again), 0.0) << "loaded in the caller's thread it is deterministic";
  for (std::size_t i = 0; i < nearby.tracked.size(); ++i) {
    EXPECT_EQ(nearby.tracked[i].points, again.tracked[i].points);
  }
}

TEST_F(NearbyMapTest, LoadsInTheBackgroundWhileTheCameraMoves) {
  const auto system = in_part(keyframes_ / 2, true);
  int tracked = 0, frames = 0;
  for (int i = 10; i < 120; ++i) {
    // As fast as a camera, once it knows where it is; before it has all the time there is.
    const Result<FrameReport> report = system->process(wall().frame(tracked == 0 ? 10 : i));
    ASSERT_TRUE(report.ok());
    if (tracked == 0 && report->track.state != TrackingState::tracking && frames < 2000) {
      --i;
      ++frames;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      continue;
    }
    tracked += report->track.state == TrackingState::tracking ? 1 : 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_GT(tracked, 80);
  EXPECT_TRUE(system->finish());
  EXPECT_EQ(system->trajectory().size(), static_cast<std::size_t>(tracked))
      << "references that are far by now have their place";
}

TEST_F(NearbyMapTest, APartIsNeitherMappedInNorSaved) {
  const auto system = in_part(keyframes_ / 2);
  system->set_localization_only(false);
  EXPECT_TRUE(system->localization_only());
  EXPECT_FALSE(system->save_map(temporary_->path() / "part.map").ok());
  EXPECT_FALSE(system->autosave_to(temporary_->path() / "part.map").ok());
  EXPECT_FALSE(fs::exists(temporary_->path() / "part.map"));
  system->reset();  // and then it is a system like any other
  EXPECT_TRUE(system->process(wall().frame(0)).ok());
  EXPECT_EQ(system->atlas()->keyframes().size(), 1U);
  EXPECT_TRUE(system->save_map(temporary_->path() / "new.map").ok());
}

TEST_F(NearbyMapTest, DamageFarAwayEndsTheRunWhenTheCameraComesThere) {
  const fs::path damaged = temporary_->path() / "damaged.map";
  fs::copy_file(file(), damaged);
  std::uint32_t last = 0;
  load_map(file())->keyframes().for_each([&](KeyFrameId id, const KeyFrame& k) {
    if (k.frame_index < 90 && k.frame_index > 60) last = id.slot;
  });
  sqlite3* connection = nullptr;
  ASSERT_EQ(sqlite3_open(damaged.c_str(), &connection), SQLITE_OK);
  sqlite3_exec(
      connection,
      ("UPDATE features SET keypoints = X'00' WHERE key = " + std::to_string(last)).c_str(),
      nullptr, nullptr, nullptr);
  sqlite3_close(connection);
  auto map = NearbyMap::open(StoredMap::open(damaged).value(), of_keyframes(keyframes_ / 2));
  ASSERT_TRUE(map.ok()) << map.error().message;
  SlamSystem system(wall().camera(), nearby_options(true), ObjectCatalogue::defaults(), nullptr,
                    std::move(*map));
  Result<void> ended;
  for (int i = 0; i < 90 && ended; ++i) {
    const auto report = system.process(wall().frame(i));
    if (!report) ended = report.error();
  }
  ASSERT_FALSE(ended);
  EXPECT_THAT(ended.error().message, testing::HasSubstr("damaged.map: is damaged (table features"));
}

}  // namespace
}  // namespace ydd
