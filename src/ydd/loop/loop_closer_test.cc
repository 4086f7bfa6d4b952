// SPDX-License-Identifier: Apache-2.0
#include "ydd/loop/loop_closer.h"

#include <algorithm>
#include <numbers>

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

/// A long way out and round, in keyframes that see nothing, with drift that a loop takes out.
struct LongWay {
  Atlas atlas{Camera(), PyramidScales::make(8, 1.2)};
  std::vector<KeyFrameId> ids;
  LoopMatch match;
};

LongWay long_way(int keyframes) {
  LongWay way;
  const MapId map = way.atlas.new_map();
  Vector6d step;
  step << 0.2, 0, 0.01, 0, 2.0 * std::numbers::pi / keyframes, 0;
  SE3 T_world_camera;
  for (int i = 0; i < keyframes; ++i) {
    KeyFrame keyframe;
    keyframe.map = map;
    keyframe.shared_features = std::make_shared<const Features>();
    keyframe.T_world_camera = T_world_camera;
    if (!way.ids.empty()) keyframe.parent = way.ids.back();
    way.ids.push_back(way.atlas.add_keyframe(std::move(keyframe)));
    T_world_camera = T_world_camera * SE3::exp(step);
  }
  Vector6d drift;
  drift << 0.3, 0.1, -0.2, 0.01, 0.02, -0.01;
  way.match = {way.ids.back(),
               way.ids.front(),
               way.atlas.at(way.ids.back()).T_world_camera * SE3::exp(drift),
               {}};
  return way;
}

TEST(CorrectLoop, InGroupsItSpreadsTheDriftAsKeyframeByKeyframe) {
  const LongWay way = long_way(1200);
  LoopOptions groups = quick_options();
  groups.graph_nodes = 100;
  const Correction exact = correct_loop(way.atlas, way.match, quick_options()).value();
  const Correction coarse = correct_loop(way.atlas, way.match, groups).value();
  ASSERT_EQ(coarse.T_world_keyframe.size(), way.ids.size());
  double largest_m = 0, correction_m = 0;
  for (const KeyFrameId id : way.ids) {
    const SE3& fine = exact.T_world_keyframe.at(id);
    largest_m =
        std::max(largest_m, (fine.inverse() * coarse.T_world_keyframe.at(id)).translation().norm());
    correction_m = std::max(
        correction_m, (fine.inverse() * way.atlas.at(id).T_world_camera).translation().norm());
  }
  EXPECT_GT(correction_m, 0.3);
  EXPECT_LT(largest_m, 0.05 * correction_m);
  const SE3 gap =
      way.match.T_world_current.inverse() * coarse.T_world_keyframe.at(way.match.current);
  EXPECT_LT(gap.translation().norm(), 0.02);
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

/// Half the squared distances between where the points of the map are and where keyframes see them,
/// cut off as the bundle does.
double reprojection_cost(const Atlas& atlas) {
  const BundleOptions options;
  double cost = 0;
  atlas.points().for_each([&](MapPointId, const MapPoint& point) {
    for (const Observation& o : point.observations) {
      const KeyFrame& keyframe = atlas.at(o.keyframe);
      const Eigen::Vector3d seen = uvr_px(keyframe.features(), o.keypoint);
      const Eigen::Vector3d p_camera = keyframe.T_world_camera.inverse() * point.p_world;
      const Eigen::Vector2d px = atlas.camera().project(p_camera);
      const bool mono = seen.z() < 0;
      const double right_px = mono ? 0.0 : px.x() - atlas.camera().bf() / p_camera.z() - seen.z();
      const auto octave = static_cast<std::size_t>(
          keyframe.features().keypoints[static_cast<std::size_t>(o.keypoint)].octave);
      const double chi2 = ((px - seen.head<2>()).squaredNorm() + right_px * right_px) *
                          atlas.scales().inv_sigma2[octave];
      const double gate = mono ? options.chi2_mono : options.chi2_stereo;
      cost += 0.5 * (chi2 <= gate ? chi2 : 2.0 * std::sqrt(gate * chi2) - gate);
    }
  });
  return cost;
}

TEST(FullBundle, InterruptedAfterAnIterationItGivesWhatThatReached) {
  TwoVisits visits = two_visits(SE3(), true);
  Vector6d twist;
  twist << 0.03, -0.02, 0.02, 0.005, 0.0, -0.004;
  const KeyFrameId shaken = visits.old_keyframes[5];
  visits.atlas.set_pose(shaken, visits.atlas.at(shaken).T_world_camera * SE3::exp(twist));
  const auto cost_after = [&](int iterations) -> std::optional<double> {
    std::stop_source stop;
    int seen = 0;
    const auto correction =
        full_bundle(visits.atlas, shaken, quick_options(), stop.get_token(), [&](int) {
          if (++seen == iterations) stop.request_stop();
        });
    if (!correction) return std::nullopt;
    EXPECT_EQ(correction->revision, visits.atlas.revision());
    TwoVisits moved = two_visits(SE3(), true);  // the same map once more
    moved.atlas.set_pose(shaken, moved.atlas.at(shaken).T_world_camera * SE3::exp(twist));
    for (const auto& [id, pose] : correction->T_world_keyframe) moved.atlas.set_pose(id, pose);
    for (const auto& [id, p_world] : correction->p_world) moved.atlas.set_position(id, p_world);
    EXPECT_TRUE(moved.atlas.check_consistency().empty());
    return reprojection_cost(moved.atlas);
  };
  const double before = reprojection_cost(visits.atlas);
  const auto one = cost_after(1), whole = cost_after(1000);
  ASSERT_TRUE(one && whole);
  EXPECT_LT(*one, before);
  EXPECT_LT(*whole, *one) << "one iteration was not all: it was interrupted";
}

TEST(FullBundle, OfALargeMapAdjustsWhatIsAroundTheLoop) {
  TwoVisits visits = two_visits(SE3(), true);
  Vector6d twist;
  twist << 0.03, -0.02, 0.02, 0.005, 0.0, -0.004;
  const KeyFrameId shaken = visits.old_keyframes[5];
  const SE3 truth = visits.atlas.at(shaken).T_world_camera;
  visits.atlas.set_pose(shaken, truth * SE3::exp(twist));
  LoopOptions options = quick_options();
  options.bundle_keyframes = 10;
  const auto correction = full_bundle(visits.atlas, shaken, options);
  ASSERT_TRUE(correction.has_value());
  EXPECT_EQ(correction->newcomers_from, visits.atlas.next_serial());
  EXPECT_LE(correction->T_world_keyframe.size(), 10U);
  EXPECT_GE(correction->T_world_keyframe.size(), 9U);  // the one that holds it may be the first
  EXPECT_LT((truth.inverse() * correction->T_world_keyframe.at(shaken)).translation().norm(), 0.01);
}

}  // namespace
}  // namespace ydd
