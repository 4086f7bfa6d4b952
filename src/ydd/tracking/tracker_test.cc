// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracking/tracker.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/tracking/tracker_walk_testing.h"

namespace ydd {
namespace {

using testing_world::position_error_m;
using testing_world::rotation_error_rad;
using testing_world::Walk;

TEST(Tracker, StartsAMapWithTheFirstFrameThatHasDepth) {
  Walk walk;
  const TrackResult dark = walk.step_blind();
  EXPECT_EQ(dark.state, TrackingState::initializing);
  EXPECT_FALSE(dark.candidate.has_value());
  const TrackResult first = walk.step();
  EXPECT_EQ(first.state, TrackingState::tracking);
  ASSERT_TRUE(first.candidate.has_value());
  EXPECT_FALSE(first.candidate->reference.valid());
  EXPECT_EQ(walk.atlas().keyframes().size(), 1U);
  const TrackResult second = walk.step();
  EXPECT_EQ(second.state, TrackingState::tracking);
  EXPECT_EQ(second.reference, walk.atlas().newest_keyframe());
}

TEST(Tracker, FindsItsPlaceInAMapThatIsThereAndExtendsIt) {
  Walk walk;
  for (int i = 0; i < 60; ++i) walk.step();
  walk.restart();
  const std::size_t keyframes = walk.atlas().keyframes().size();
  EXPECT_EQ(walk.step_blind().state, TrackingState::lost);
  const TrackResult found = walk.step();
  ASSERT_EQ(found.state, TrackingState::tracking);
  EXPECT_LT(position_error_m(found.T_world_camera, Walk::path(61)), 0.02);
  for (int i = 0; i < 28; ++i)
    EXPECT_FALSE(walk.step().candidate.has_value()) << "arrival.duration_s";
  for (int i = 28; i < 60; ++i) ASSERT_EQ(walk.step().state, TrackingState::tracking);
  EXPECT_GT(walk.atlas().keyframes().size(), keyframes);
  EXPECT_EQ(walk.atlas().maps(), 1U);
}

TEST(Tracker, StartsANewMapWhereTheOneThatIsThereIsNotSeen) {
  Walk walk;
  for (int i = 0; i < 30; ++i) walk.step();
  walk.restart();
  int frames = 0;
  while (walk.step_elsewhere().state != TrackingState::tracking && frames < 200) ++frames;
  EXPECT_NEAR(frames, 90, 2);  // new_map_after_s
  EXPECT_EQ(walk.atlas().maps(), 2U);
}

TEST(Tracker, LocalizationOnlyLeavesTheMapAlone) {
  Walk walk;
  for (int i = 0; i < 60; ++i) walk.step();
  const std::uint64_t revision = walk.atlas().revision();
  walk.restart();
  walk.tracker().set_localization_only(true);
  for (int i = 0; i < 60; ++i) {
    const TrackResult result = walk.step();
    ASSERT_EQ(result.state, TrackingState::tracking);
    EXPECT_FALSE(result.candidate.has_value());
    EXPECT_LT(position_error_m(result.T_world_camera, Walk::path(60 + i)), 0.03);
  }
  for (int i = 0; i < 120; ++i) {
    ASSERT_EQ(walk.step_elsewhere().state, TrackingState::lost);  // for longer than new_map_after_s
  }
  EXPECT_EQ(walk.atlas().revision(), revision);
  walk.tracker().set_localization_only(false);
  EXPECT_TRUE(walk.step_elsewhere().candidate.has_value());
}

TEST(Tracker, FollowsTheCamera) {
  Walk walk;
  int keyframes = 0;
  for (int i = 0; i < 120; ++i) {
    const TrackResult result = walk.step();
    ASSERT_EQ(result.state, TrackingState::tracking) << "frame " << i;
    if (result.candidate) ++keyframes;
    if (i == 0) continue;
    // The map is not refined: points are where one noisy reading put them.
    EXPECT_LT(position_error_m(result.T_world_camera, Walk::path(i)), 0.02) << "frame " << i;
    EXPECT_LT(rotation_error_rad(result.T_world_camera, Walk::path(i)), 0.004) << "frame " << i;
    EXPECT_GT(result.inliers, 100);
    EXPECT_EQ(result.points.size(), walk.view().features().size());
    // The pose is also told relative to a keyframe.
    const SE3 by_reference =
        *walk.atlas().T_world_keyframe(result.reference) * result.T_reference_camera;
    EXPECT_LT(position_error_m(by_reference, result.T_world_camera), 1e-9);
  }
  EXPECT_GE(keyframes, 3);
  EXPECT_LE(keyframes, 60);
  EXPECT_THAT(walk.atlas().check_consistency(), testing::IsEmpty());
}

TEST(Tracker, PointsOfAFrameAreThoseItShows) {
  Walk walk;
  for (int i = 0; i < 10; ++i) walk.step();
  const TrackResult result = walk.step();
  std::vector<MapPointId> seen;
  for (std::size_t k = 0; k < result.points.size(); ++k) {
    if (!result.points[k].valid()) continue;
    seen.push_back(result.points[k]);
    EXPECT_LE(hamming_distance(walk.atlas().at(result.points[k]).descriptor,
                               walk.view().features().descriptors[k]),
              30);
  }
  EXPECT_GT(result.inliers, 100);
  EXPECT_EQ(static_cast<int>(seen.size()), result.inliers);
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end()) << "a point twice";
}

TEST(Tracker, IsLostWithoutFeaturesAndFindsItselfAgain) {
  Walk walk;
  for (int i = 0; i < 30; ++i) walk.step();
  for (int i = 0; i < 5; ++i) {
    const TrackResult blind = walk.step_blind();
    EXPECT_EQ(blind.state, TrackingState::lost);
    EXPECT_FALSE(blind.candidate.has_value());
  }
  EXPECT_EQ(walk.tracker().state(), TrackingState::lost);
  const TrackResult back = walk.step();
  EXPECT_EQ(back.state, TrackingState::tracking);
  EXPECT_LT(position_error_m(back.T_world_camera, Walk::path(35)), 0.02);
  EXPECT_EQ(walk.step().state, TrackingState::tracking);
}

TEST(Tracker, AYoungMapThatIsLostIsNotWaitedFor) {
  TrackerOptions options;
  options.new_map_after_s = 3600;
  Walk walk(options);
  walk.step();  // the one picture of the map is a stale one
  const TrackResult fresh = walk.step_elsewhere();
  EXPECT_EQ(fresh.state, TrackingState::tracking);
  ASSERT_TRUE(fresh.candidate.has_value());
  EXPECT_FALSE(fresh.candidate->reference.valid());
  EXPECT_EQ(walk.step_elsewhere().state, TrackingState::tracking);
}

TEST(Tracker, StartsAnotherMapWhenLostForTooLong) {
  TrackerOptions options;
  options.new_map_after_s = 0.19;  // six frames
  options.young_map_keyframes = 0;
  Walk walk(options);
  for (int i = 0; i < 10; ++i) walk.step();
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(walk.step_elsewhere().state, TrackingState::lost) << "after " << i;
  }
  const TrackResult fresh = walk.step_elsewhere();
  EXPECT_EQ(fresh.state, TrackingState::tracking);
  ASSERT_TRUE(fresh.candidate.has_value());
  EXPECT_FALSE(fresh.candidate->reference.valid());
  const TrackResult next = walk.step_elsewhere();
  EXPECT_EQ(next.state, TrackingState::tracking);
  EXPECT_NE(walk.atlas().map_of(next.reference),
            walk.atlas().map_of(walk.atlas().keyframes().ids().front()));
  EXPECT_THAT(walk.atlas().check_consistency(), testing::IsEmpty());
}

TEST(Tracker, AFewFeaturesAreNotEnoughToClaimAPose) {
  Walk walk;
  for (int i = 0; i < 10; ++i) walk.step();
  EXPECT_EQ(walk.step(Walk::path(10), 0.02).state, TrackingState::lost);
}

TEST(Tracker, FindsACarriedCameraBySight) {
  Walk walk;
  for (int i = 0; i < 60; ++i) walk.step();
  // Suddenly half a metre and 0.2 rad away: no motion model helps.
  Vector6d twist;
  twist << -0.4, 0.3, 0.2, 0.1, -0.15, 0.1;
  const SE3 T_carried = Walk::path(60) * SE3::exp(twist);
  const TrackResult result = walk.step(T_carried);
  ASSERT_EQ(result.state, TrackingState::tracking);
  EXPECT_LT(position_error_m(result.T_world_camera, T_carried), 0.02);
}

TEST(Tracker, FollowsAMapThatTheMapperMoved) {
  Walk walk;
  for (int i = 0; i < 30; ++i) walk.step();
  const SE3 T_moved = SE3::exp((Vector6d() << 0.5, -0.2, 0.1, 0.02, 0.05, -0.03).finished());
  for (const KeyFrameId id : walk.atlas().keyframes().ids()) {
    walk.atlas().set_pose(id, T_moved * walk.atlas().at(id).T_world_camera);
  }
  for (const MapPointId id : walk.atlas().points().ids()) {
    walk.atlas().set_position(id, T_moved * walk.atlas().at(id).p_world);
  }
  for (const MapPointId id : walk.atlas().points().ids()) walk.atlas().refresh_point(id);
  const TrackResult result = walk.step();
  ASSERT_EQ(result.state, TrackingState::tracking);
  EXPECT_GT(result.motion_inliers, 100);  // by motion, not by relocalisation
  EXPECT_LT(position_error_m(result.T_world_camera, T_moved * Walk::path(30)), 0.02);
}

TEST(Tracker, CountsHowOftenPointsWereSeen) {
  Walk walk;
  int candidates = 0;
  for (int i = 0; i < 40; ++i) {
    const TrackResult result = walk.step();
    if (!result.candidate || i == 0) continue;
    ++candidates;
    EXPECT_FALSE(result.candidate->views.empty());
    for (const PointViews& views : result.candidate->views) {
      EXPECT_GE(views.visible, views.found);
      EXPECT_GE(views.found, 0);
      EXPECT_GT(views.visible, 0);
    }
  }
  EXPECT_GE(candidates, 1);
}

TEST(Tracker, IsDeterministic) {
  Walk a;
  Walk b;
  for (int i = 0; i < 60; ++i) {
    const bool blind = i > 30 && i < 34;
    const TrackResult from_a = blind ? a.step_blind() : a.step();
    const TrackResult from_b = blind ? b.step_blind() : b.step();
    ASSERT_EQ(from_a.state, from_b.state);
    ASSERT_EQ(from_a.T_world_camera.matrix(), from_b.T_world_camera.matrix()) << "frame " << i;
    ASSERT_EQ(from_a.points, from_b.points);
    ASSERT_EQ(from_a.candidate.has_value(), from_b.candidate.has_value());
  }
}

}  // namespace
}  // namespace ydd
