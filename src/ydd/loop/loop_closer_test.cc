// SPDX-License-Identifier: Apache-2.0
#include "ydd/loop/loop_closer.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "ydd/loop/loop_testing.h"

namespace ydd {
namespace {

using namespace testing_world;  // NOLINT(google-build-using-namespace)

TEST(FindLoop, RecognisesThePlaceAndMeasuresTheDrift) {
  const TwoVisits visits = two_visits(small_drift(), true);
  ASSERT_TRUE(visits.atlas.check_consistency().empty());
  const auto match = find_loop(visits.atlas, visits.new_keyframes.back(), quick_options());
  ASSERT_TRUE(match.has_value());
  EXPECT_NE(std::find(visits.old_keyframes.begin(), visits.old_keyframes.end(), match->matched),
            visits.old_keyframes.end());
  const SE3 error = visits.T_world_new.back().inverse() * match->T_world_current;
  EXPECT_LT(error.translation().norm(), 0.02);
  EXPECT_LT(error.angle_rad(), 0.01);
}

TEST(FindLoop, AStrangePlaceIsNoLoop) {
  const TwoVisits visits = two_visits(small_drift(), false);
  for (const KeyFrameId id : visits.new_keyframes) {
    EXPECT_FALSE(find_loop(visits.atlas, id, quick_options()).has_value());
  }
}

TEST(FindLoop, MoreThanACameraDriftsIsAnotherPlaceThatLooksAlike) {
  const TwoVisits visits = two_visits(small_drift(), true);
  LoopOptions options = quick_options();
  options.max_drift_m = 0.1;
  options.max_drift_share = 0.0;
  EXPECT_FALSE(find_loop(visits.atlas, visits.new_keyframes.back(), options).has_value());
  options.max_drift_share = 1.0;  // the more of the way may be drift, the more is plausible
  EXPECT_TRUE(find_loop(visits.atlas, visits.new_keyframes.back(), options).has_value());
}

TEST(FindLoop, TheWayOfTheCameraDoesNotCountBetweenMaps) {
  const TwoVisits visits = two_visits(small_drift(), true, true);
  LoopOptions options = quick_options();
  options.max_drift_m = options.max_drift_share = 0.0;
  EXPECT_TRUE(find_loop(visits.atlas, visits.new_keyframes.back(), options).has_value());
}

TEST(FindLoop, BetweenMapsAPlaceThatIsThereTwiceIsNone) {
  TwoVisits visits = two_visits(small_drift(), true, true);
  const KeyFrameId current = visits.new_keyframes.back();
  ASSERT_TRUE(find_loop(visits.atlas, current, quick_options()).has_value());
  // The same things once more, three metres farther on in the first map.
  const PointWorld world = make_world(700, 3);
  add_visit(visits.atlas, world, views_of(world, kOldViews, 0.0, 201),
            SE3(Eigen::Quaterniond::Identity(), {3.0, 0.0, 0.0}), visits.first_map,
            visits.old_keyframes.back());
  EXPECT_FALSE(find_loop(visits.atlas, current, quick_options()).has_value());
}

TEST(FindLoop, OffMeansOff) {
  const TwoVisits visits = two_visits(small_drift(), true);
  LoopOptions options = quick_options();
  options.enabled = false;
  EXPECT_FALSE(find_loop(visits.atlas, visits.new_keyframes.back(), options).has_value());
}

TEST(FindLoop, KeyframesThatSharePointsAreNoNews) {
  const TwoVisits visits = two_visits(SE3(), false);
  EXPECT_FALSE(find_loop(visits.atlas, visits.old_keyframes.back(), quick_options()).has_value());
}

TEST(CorrectLoop, BringsTheDriftedKeyframeBack) {
  const TwoVisits visits = two_visits(small_drift(), true);
  const auto match = find_loop(visits.atlas, visits.new_keyframes.back(), quick_options());
  ASSERT_TRUE(match.has_value());
  const Correction correction = correct_loop(visits.atlas, *match, quick_options()).value();
  const SE3 before = visits.atlas.at(visits.new_keyframes.back()).T_world_camera;
  const SE3 after = correction.T_world_keyframe.at(visits.new_keyframes.back());
  const SE3& truth = visits.T_world_new.back();
  EXPECT_LT((truth.inverse() * after).translation().norm(),
            0.5 * (truth.inverse() * before).translation().norm());
  // The map's first keyframe holds the world.
  const SE3 first = visits.atlas.at(visits.old_keyframes.front()).T_world_camera;
  EXPECT_LT((first.inverse() * correction.T_world_keyframe.at(visits.old_keyframes.front()))
                .translation()
                .norm(),
            1e-9);
}

TEST(CorrectLoop, AnotherMapIsMovedRigidlyOntoTheOlderOne) {
  const TwoVisits visits = two_visits(small_drift(), true, true);
  const auto match = find_loop(visits.atlas, visits.new_keyframes.back(), quick_options());
  ASSERT_TRUE(match.has_value());
  const Correction correction = correct_loop(visits.atlas, *match, quick_options()).value();
  EXPECT_EQ(correction.T_world_keyframe.size(), visits.new_keyframes.size());
  for (std::size_t i = 0; i < visits.new_keyframes.size(); ++i) {
    const SE3 error =
        visits.T_world_new[i].inverse() * correction.T_world_keyframe.at(visits.new_keyframes[i]);
    EXPECT_LT(error.translation().norm(), 0.03);
  }
}

TEST(CorrectLoop, TheYoungerMapMovesAlsoWhenTheOlderOneMeetsIt) {
  const TwoVisits visits = two_visits(small_drift(), true, true);
  const auto match = find_loop(visits.atlas, visits.old_keyframes[2], quick_options());
  ASSERT_TRUE(match.has_value());
  ASSERT_NE(visits.atlas.at(match->matched).map, visits.first_map);
  const Correction correction = correct_loop(visits.atlas, *match, quick_options()).value();
  ASSERT_EQ(correction.T_world_keyframe.size(), visits.new_keyframes.size());
  ASSERT_TRUE(correction.junction.has_value());
  EXPECT_EQ(correction.junction->matched, visits.old_keyframes[2]);
  for (std::size_t i = 0; i < visits.new_keyframes.size(); ++i) {
    const SE3 error =
        visits.T_world_new[i].inverse() * correction.T_world_keyframe.at(visits.new_keyframes[i]);
    EXPECT_LT(error.translation().norm(), 0.03);
  }
}

TEST(CorrectLoop, SaysOnWhichStateOfTheMapItWasComputed) {
  for (const bool own_map : {false, true}) {
    const TwoVisits visits = two_visits(small_drift(), true, own_map);
    const auto match = find_loop(visits.atlas, visits.new_keyframes.back(), quick_options());
    ASSERT_TRUE(match.has_value());
    const auto correction = correct_loop(visits.atlas, *match, quick_options());
    EXPECT_EQ(correction->revision, visits.atlas.revision());
  }
}

TEST(CorrectLoop, AStopInterruptsIt) {
  const TwoVisits visits = two_visits(small_drift(), true);
  const auto match = find_loop(visits.atlas, visits.new_keyframes.back(), quick_options());
  ASSERT_TRUE(match.has_value());
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(correct_loop(visits.atlas, *match, quick_options(), stop.get_token()).has_value());
  EXPECT_FALSE(full_bundle(visits.atlas, match->current, quick_options(), stop.get_token()));
}

TEST(FullBundle, ReducesTheErrorOfAShakenMap) {
  TwoVisits visits = two_visits(SE3(), true);
  Vector6d twist;
  twist << 0.03, -0.02, 0.02, 0.005, 0.0, -0.004;
  const KeyFrameId shaken = visits.old_keyframes[5];
  const SE3 truth = visits.atlas.at(shaken).T_world_camera;
  visits.atlas.set_pose(shaken, truth * SE3::exp(twist));
  const auto correction = full_bundle(visits.atlas, shaken, quick_options());
  ASSERT_TRUE(correction.has_value());
  EXPECT_EQ(correction->revision, visits.atlas.revision());
  EXPECT_LT((truth.inverse() * correction->T_world_keyframe.at(shaken)).translation().norm(), 0.01);
}

}  // namespace
}  // namespace ydd
