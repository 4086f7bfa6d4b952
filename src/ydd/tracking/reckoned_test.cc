// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/tracking/tracker_walk_testing.h"

namespace ydd {
namespace {

using testing_world::PointWorld;
using testing_world::position_error_m;
using testing_world::Walk;

/// Senses that are right but for a drift of so much a frame.
Walk::Senses drifting(double drift_m) {
  return [drift_m](std::int64_t then, std::int64_t now) {
    const double off_m = drift_m * static_cast<double>(now - then);
    ReckonedMotion motion;
    motion.T_now_then = SE3(Eigen::Quaterniond::Identity(), {off_m, 0, 0}) *
                        Walk::path(now).inverse() * Walk::path(then);
    motion.has_place = true;
    motion.sigma_m = std::max(0.003, off_m);
    motion.sigma_rad = 0.002;
    return motion;
  };
}

TEST(ReckonedTracking, ABlindCameraHasAPoseAllTheTime) {
  Walk walk;
  walk.set_senses(drifting(0.0005));
  for (int i = 0; i < 40; ++i) walk.step();
  for (int i = 40; i < 100; ++i) {
    const TrackResult blind = walk.step_blind();
    ASSERT_EQ(blind.state, TrackingState::coasting) << "frame " << i;
    ASSERT_TRUE(blind.reckoned && blind.reference.valid());
    EXPECT_FALSE(blind.candidate) << "nothing of it enters the map";
    EXPECT_LT(position_error_m(blind.T_world_camera, Walk::path(i)), 0.06);
    const SE3 since_last = Walk::path(i).inverse() * Walk::path(i - 1);
    EXPECT_LT((*blind.T_camera_last * since_last.inverse()).translation().norm(), 0.03);
  }
  const TrackResult found = walk.step();
  ASSERT_EQ(found.state, TrackingState::tracking);
  EXPECT_FALSE(found.reckoned);
  EXPECT_LT(position_error_m(found.T_world_camera, Walk::path(100)), 0.03);
  const SE3 whole = Walk::path(100).inverse() * Walk::path(39);
  EXPECT_LT((*found.T_camera_seen * whole.inverse()).translation().norm(), 0.04);
}

TEST(ReckonedTracking, WithoutSensesABlindCameraIsLost) {
  Walk walk;
  for (int i = 0; i < 40; ++i) walk.step();
  EXPECT_EQ(walk.step_blind().state, TrackingState::lost);
}

TEST(ReckonedTracking, ATurnAloneIsNoPlaceForLong) {
  Walk walk;
  const Walk::Senses whole = drifting(0);
  walk.set_senses([&](std::int64_t then, std::int64_t now) {
    ReckonedMotion motion = whole(then, now);
    motion.has_place = false;
    return motion;
  });
  for (int i = 0; i < 40; ++i) ASSERT_EQ(walk.step().state, TrackingState::tracking);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(walk.step_blind().state, TrackingState::coasting);
  walk.step_blind();
  EXPECT_EQ(walk.step_blind().state, TrackingState::lost);
}

TEST(ReckonedTracking, AnUnknownViewEntersTheSameMap) {
  Walk walk;
  walk.set_senses(drifting(0));
  for (int i = 0; i < 40; ++i) walk.step();
  const std::size_t before = walk.atlas().keyframes().size();
  walk.step_blind();
  int frames = 1;
  while (!walk.step_elsewhere().candidate) ASSERT_LT(++frames, 40);
  EXPECT_GE(frames, 15) << "half a second is given to find what is known";
  EXPECT_EQ(walk.atlas().keyframes().size(), before + 1);
  const TrackResult next = walk.step_elsewhere();
  EXPECT_EQ(next.state, TrackingState::tracking) << "in what has just been mapped";
  EXPECT_LT(position_error_m(next.T_world_camera, Walk::path(40 + frames + 1)), 0.03);
  EXPECT_EQ(walk.atlas().at(next.reference).map,
            walk.atlas().at(walk.atlas().newest_keyframe()).map);
  EXPECT_THAT(walk.atlas().check_consistency(), testing::IsEmpty());
}

TEST(ReckonedTracking, LocalizationOnlyMapsNoUnknownView) {
  Walk walk;
  walk.set_senses(drifting(0));
  for (int i = 0; i < 40; ++i) walk.step();
  walk.tracker().set_localization_only(true);
  const std::size_t before = walk.atlas().keyframes().size();
  walk.step_blind();
  for (int i = 0; i < 40; ++i) EXPECT_FALSE(walk.step_elsewhere().candidate);
  EXPECT_EQ(walk.atlas().keyframes().size(), before);
}

/// Wheels of a robot that is carried feel nothing: what it then sees through walls tells.
TEST(ReckonedTracking, WhoSeesThroughTheMapHasBeenCarried) {
  Walk walk;
  walk.set_senses(drifting(0));
  for (int i = 0; i < 40; ++i) walk.step();
  PointWorld hall = testing_world::make_world(1200, 80);
  for (std::size_t i = 0; i < hall.p_world.size(); ++i) {  // a wall behind most of the room
    const double farther = 3.9 / hall.p_world[i].z();
    hall.p_world[i] *= farther;
    hall.farthest_m[i] *= farther;
  }
  const TrackResult carried = walk.step_in(hall, Walk::path(40), 1.0);
  EXPECT_FALSE(carried.reckoned);
  ASSERT_TRUE(carried.candidate) << "a young map is left at once";
  EXPECT_FALSE(carried.candidate->reference.valid()) << "for a new one";
}

TEST(ReckonedTracking, WhatStandsBeforeTheMapContradictsNothing) {
  Walk walk;
  walk.set_senses(drifting(0));
  for (int i = 0; i < 40; ++i) walk.step();
  PointWorld crowd = testing_world::make_world(1200, 80);
  for (Eigen::Vector3d& p : crowd.p_world) p *= 0.3;
  for (double& m : crowd.farthest_m) m *= 0.3;
  EXPECT_EQ(walk.step_in(crowd, Walk::path(40), 1.0).state, TrackingState::coasting);
}

/// A place that looks like a known one is not that place where the senses know better.
TEST(ReckonedTracking, IsNotFoundWhereItCannotBe) {
  Walk walk;
  walk.set_senses(drifting(0));
  for (int i = 0; i < 40; ++i) walk.step();
  for (int i = 0; i < 5; ++i) walk.step_blind();
  const TrackResult elsewhere = walk.step(Walk::path(45) * SE3(so3_exp({0, 0.5, 0}), {0.5, 0, 0}));
  EXPECT_TRUE(elsewhere.reckoned) << "half a metre is more than it can have gone";
  EXPECT_EQ(walk.step(Walk::path(46)).state, TrackingState::tracking);
}

}  // namespace
}  // namespace ydd
