// SPDX-License-Identifier: Apache-2.0
#include "ydd/loop/loop_closer.h"

#include <gtest/gtest.h>

#include "ydd/map/world_testing.h"

namespace ydd {
namespace {

using namespace testing_world;  // NOLINT(google-build-using-namespace)

constexpr int kOldViews = 14;
constexpr int kNewViews = 6;

/// A map of a place, and a stretch of keyframes that sees a place later without knowing the first:
/// it has points of its own, displaced by `drift`.
struct TwoVisits {
  Atlas atlas;
  MapId first_map;
  std::vector<KeyFrameId> old_keyframes, new_keyframes;
  std::vector<SE3> T_world_new;  ///< true poses
};

KeyFrame described(const View& view, std::int64_t frame, MapId map) {
  KeyFrame keyframe = keyframe_of(view, frame);
  keyframe.map = map;
  keyframe.words = std::make_shared<const BagOfWords>(
      bag_of_words(builtin_vocabulary(), view.features().descriptors));
  return keyframe;
}

/// Adds keyframes of views, with points of their own where `drift` puts them.
std::vector<KeyFrameId> add_visit(Atlas& atlas, const PointWorld& world,
                                  const std::vector<View>& views, const SE3& drift, MapId map,
                                  KeyFrameId parent) {
  std::vector<KeyFrameId> ids;
  std::vector<MapPointId> points(world.p_world.size());
  for (const View& view : views) {
    KeyFrame keyframe = described(view, static_cast<std::int64_t>(atlas.keyframes().size()), map);
    keyframe.T_world_camera = drift * view.T_world_camera;
    keyframe.parent = ids.empty() ? parent : ids.back();
    const KeyFrameId id = atlas.add_keyframe(std::move(keyframe));
    for (std::size_t k = 0; k < view.shown.size(); ++k) {
      MapPointId& point = points[static_cast<std::size_t>(view.shown[k])];
      if (point.valid()) {
        atlas.add_sighting(point, id, static_cast<int>(k));
      } else {
        point = atlas.add_point(drift * world.p_world[static_cast<std::size_t>(view.shown[k])], id,
                                static_cast<int>(k));
      }
    }
    ids.push_back(id);
  }
  for (const KeyFrameId id : ids) atlas.refresh_covisibility(id, 15);
  for (const MapPointId id : points) {
    if (id.valid()) atlas.refresh_point(id);
  }
  return ids;
}

std::vector<View> views_of(const PointWorld& world, int count, double start_s, unsigned seed) {
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    ViewOptions options;
    options.noise_px = 0.3;
    options.flipped_bits = 12;
    options.seed = seed + static_cast<unsigned>(i);
    views.push_back(look(world, hand_held(start_s + 0.2 * i), options));
  }
  return views;
}

/// `same_place`: the second visit sees the first one's world, else a stranger.
TwoVisits two_visits(const SE3& drift, bool same_place, bool own_map = false) {
  const PointWorld world = make_world(700, 3);
  const PointWorld stranger = make_world(700, 4);
  TwoVisits visits{Atlas(world.camera, world.scales), {}, {}, {}, {}};
  visits.first_map = visits.atlas.new_map();
  visits.old_keyframes = add_visit(visits.atlas, world, views_of(world, kOldViews, 0.0, 1), SE3(),
                                   visits.first_map, {});
  const PointWorld& seen = same_place ? world : stranger;
  const std::vector<View> views = views_of(seen, kNewViews, 0.1, 101);
  for (const View& view : views) visits.T_world_new.push_back(view.T_world_camera);
  const MapId map = own_map ? visits.atlas.new_map() : visits.first_map;
  visits.new_keyframes = add_visit(visits.atlas, seen, views, drift, map,
                                   own_map ? KeyFrameId{} : visits.old_keyframes.back());
  return visits;
}

LoopOptions quick_options() {
  LoopOptions options;
  options.min_age_keyframes = 3;
  options.min_score_ratio = 0.5;
  options.max_drift_m = 2.0;  // the way is short, the drift of these tests is not
  return options;
}

SE3 small_drift() {
  Vector6d twist;
  twist << 0.4, -0.1, 0.3, 0.02, 0.05, -0.03;
  return SE3::exp(twist);
}

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
  const Correction correction = correct_loop(visits.atlas, *match, quick_options());
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
  const Correction correction = correct_loop(visits.atlas, *match, quick_options());
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
  const Correction correction = correct_loop(visits.atlas, *match, quick_options());
  ASSERT_EQ(correction.T_world_keyframe.size(), visits.new_keyframes.size());
  ASSERT_TRUE(correction.seam.has_value());
  EXPECT_EQ(correction.seam->matched, visits.old_keyframes[2]);
  for (std::size_t i = 0; i < visits.new_keyframes.size(); ++i) {
    const SE3 error =
        visits.T_world_new[i].inverse() * correction.T_world_keyframe.at(visits.new_keyframes[i]);
    EXPECT_LT(error.translation().norm(), 0.03);
  }
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
  EXPECT_LT((truth.inverse() * correction->T_world_keyframe.at(shaken)).translation().norm(), 0.01);
}

}  // namespace
}  // namespace ydd
