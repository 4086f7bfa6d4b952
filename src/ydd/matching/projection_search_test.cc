// SPDX-License-Identifier: Apache-2.0
#include "ydd/matching/projection_search.h"
#include "ydd/matching/viewpoint.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/matching/matching_testing.h"

namespace ydd {
namespace {

using testing_world::build_map;
using testing_world::BuiltMap;
using testing_world::frame_of;
using testing_world::hand_held;
using testing_world::known_frame_of;
using testing_world::look;
using testing_world::make_world;
using testing_world::noisy_view;
using testing_world::PointWorld;
using testing_world::View;
using testing_world::ViewOptions;

constexpr double kCloseDepth_m = 3.0;

/// Two neighbouring views of one world and a map of the first.
struct Pair {
  PointWorld world = make_world(1200, 4);
  View last = look(world, hand_held(0.4), noisy_view(1, 20));
  View next = look(world, hand_held(0.45), noisy_view(2, 20));
  BuiltMap built = build_map(world, {last});

  /// The next frame, predicted to be where the last one was.
  TrackedFrame predicted() const {
    TrackedFrame frame = frame_of(next, 1);
    frame.T_camera_world = last.T_world_camera.inverse();
    return frame;
  }
  int shown_by_both() const {
    std::vector<int> both;
    std::set_intersection(last.shown.begin(), last.shown.end(), next.shown.begin(),
                          next.shown.end(), std::back_inserter(both));
    return static_cast<int>(both.size());
  }
  int shown_by_next(const PointMatch& m) const {
    return next.shown[static_cast<std::size_t>(m.keypoint)];
  }
};

void expect_one_per_keypoint(const std::vector<PointMatch>& matches) {
  std::set<int> keypoints;
  for (const PointMatch& m : matches) {
    EXPECT_TRUE(keypoints.insert(m.keypoint).second) << "keypoint " << m.keypoint;
  }
}

TEST(PredictedOctave, FollowsTheDistance) {
  const PyramidScales scales = PyramidScales::make(8, 1.2);
  EXPECT_EQ(predicted_octave(scales, 4.0, 4.0), 0);
  EXPECT_EQ(predicted_octave(scales, 4.0, 40.0), 0);
  EXPECT_EQ(predicted_octave(scales, 4.0, 4.0 / 1.1), 1);
  EXPECT_EQ(predicted_octave(scales, 4.0, 4.0 / std::pow(1.2, 2.5)), 3);
  EXPECT_EQ(predicted_octave(scales, 4.0, 0.01), 7);
}

TEST(SearchLastFrame, RecoversMapPointsAndPointsFromDepth) {
  const Pair pair;
  const TrackedFrame last = known_frame_of(pair.last, pair.built, 0.5);
  const auto matches = search_last_frame(pair.built.atlas, last, pair.predicted(), 15.0,
                                         kCloseDepth_m, MatchLimits{});
  expect_one_per_keypoint(matches);
  int of_map = 0;
  int of_depth = 0;
  for (const PointMatch& m : matches) {
    const auto source = static_cast<std::size_t>(m.source);
    ASSERT_EQ(pair.last.shown[source], pair.shown_by_next(m));
    EXPECT_EQ(m.point, last.points[source]);
    ++(m.point.valid() ? of_map : of_depth);
    const Eigen::Vector3d& truth =
        pair.world.p_world[static_cast<std::size_t>(pair.shown_by_next(m))];
    EXPECT_LT((m.p_world - truth).norm(), m.point.valid() ? 1e-9 : 0.08);
    EXPECT_EQ(
        m.distance,
        hamming_distance(pair.last.features().descriptors[source],
                         pair.next.features().descriptors[static_cast<std::size_t>(m.keypoint)]));
  }
  EXPECT_GT(of_map, 0.4 * pair.shown_by_both());
  EXPECT_GT(of_depth, 20);
}

TEST(SearchLastFrame, TakesOnlyNearDepth) {
  const Pair pair;
  TrackedFrame last = known_frame_of(pair.last, pair.built, 0.0);
  const auto matches = search_last_frame(pair.built.atlas, last, pair.predicted(), 15.0,
                                         kCloseDepth_m, MatchLimits{});
  EXPECT_GT(matches.size(), 40U);
  for (const PointMatch& m : matches) {
    EXPECT_LE(last.features().depth_m[static_cast<std::size_t>(m.source)], kCloseDepth_m);
    EXPECT_FALSE(m.point.valid());
  }
}

TEST(SearchLastFrame, IgnoresPointsThatTheMapNoLongerHas) {
  Pair pair;
  const TrackedFrame last = known_frame_of(pair.last, pair.built, 1.0);
  std::set<MapPointId> gone;
  for (std::size_t i = 0; i < pair.built.points.size(); i += 2) {
    if (!pair.built.points[i].valid()) continue;
    gone.insert(pair.built.points[i]);
    pair.built.atlas.remove_point(pair.built.points[i]);
  }
  const auto matches = search_last_frame(pair.built.atlas, last, pair.predicted(), 15.0,
                                         kCloseDepth_m, MatchLimits{});
  for (const PointMatch& m : matches) EXPECT_FALSE(gone.contains(m.point));
  EXPECT_GT(matches.size(), 100U);
}

TEST(SearchLastFrame, RotationsMustAgree) {
  Pair pair;
  // Every eighth keypoint looks right but has turned.
  Features features = pair.next.features();
  std::set<int> turned;
  for (std::size_t i = 0; i < features.size(); i += 20) {
    features.keypoints[i].angle_rad +=
        static_cast<float>(0.4 * std::numbers::pi) + 0.21F * static_cast<float>(i % 17);
    turned.insert(static_cast<int>(i));
  }
  TrackedFrame frame = pair.predicted();
  frame.shared_features = std::make_shared<const Features>(features);
  const TrackedFrame last = known_frame_of(pair.last, pair.built);
  const auto matches =
      search_last_frame(pair.built.atlas, last, frame, 15.0, kCloseDepth_m, MatchLimits{});
  EXPECT_GT(matches.size(), 100U);
  for (const PointMatch& m : matches) EXPECT_FALSE(turned.contains(m.keypoint));
}

TEST(SearchLastFrame, FindsNothingWhenDescriptorsAreForeign) {
  Pair pair;
  PointWorld other = pair.world;
  std::mt19937_64 random(99);
  for (Descriptor& d : other.descriptors) d = testing_world::random_descriptor(random);
  TrackedFrame frame = frame_of(look(other, hand_held(0.45), noisy_view(2, 20)), 1);
  frame.T_camera_world = pair.last.T_world_camera.inverse();
  const TrackedFrame last = known_frame_of(pair.last, pair.built);
  const auto matches =
      search_last_frame(pair.built.atlas, last, frame, 15.0, kCloseDepth_m, MatchLimits{});
  EXPECT_LT(matches.size(), 8U);
}

/// Looks for the map's points in the next frame at its true pose.
LocalSearch search_at_truth(const Pair& pair, TrackedFrame& frame) {
  frame.T_camera_world = pair.next.T_world_camera.inverse();
  const LocalMap local = gather_local_map(pair.built.atlas, {}, pair.built.keyframes.front(), 80);
  return search_local_map(pair.built.atlas, local, frame, 3.0, MatchLimits{});
}

TEST(SearchLocalMap, RecoversWhatIsInView) {
  const Pair pair;
  TrackedFrame frame = frame_of(pair.next, 1);
  const LocalSearch search = search_at_truth(pair, frame);
  expect_one_per_keypoint(search.matches);
  for (const PointMatch& m : search.matches) {
    EXPECT_EQ(m.point, pair.built.points[static_cast<std::size_t>(pair.shown_by_next(m))]);
  }
  EXPECT_GT(static_cast<int>(search.matches.size()), 0.9 * pair.shown_by_both());
  EXPECT_GE(search.visible.size(), search.matches.size());
}

TEST(SearchLocalMap, LeavesWhatIsKnownAlone) {
  const Pair pair;
  TrackedFrame frame = known_frame_of(pair.next, pair.built, 0.5);
  const std::vector<MapPointId> known = frame.points;
  const LocalSearch search = search_at_truth(pair, frame);
  EXPECT_GT(search.matches.size(), 50U);
  for (const PointMatch& m : search.matches) {
    EXPECT_FALSE(known[static_cast<std::size_t>(m.keypoint)].valid());
    EXPECT_EQ(std::find(known.begin(), known.end(), m.point), known.end());
  }
}

TEST(SearchLocalMap, DoesNotSeePointsFromBehindNorFromFarOff) {
  const Pair pair;
  const LocalMap local = gather_local_map(pair.built.atlas, {}, pair.built.keyframes.front(), 80);
  TrackedFrame frame = frame_of(pair.next, 1);
  const SE3 T_behind(so3_exp({0, std::numbers::pi, 0}), {0, 0, 8});
  frame.T_camera_world = T_behind.inverse();
  EXPECT_TRUE(search_local_map(pair.built.atlas, local, frame, 3.0, {}).visible.empty());
  frame.T_camera_world = SE3(Eigen::Quaterniond::Identity(), {0, 0, 60.0});
  EXPECT_TRUE(search_local_map(pair.built.atlas, local, frame, 3.0, {}).visible.empty());
}

TEST(SearchLocalMap, DoubtfulPointsAreLeftOut) {
  // Two keypoints beside each other that look almost alike: neither is taken.
  PointWorld world = make_world(1, 4);
  world.p_world = {{0, 0, 2}, {0.004, 0, 2}};
  world.descriptors.resize(2);
  world.descriptors[0] = {0, 0, 0, 0};
  world.descriptors[1] = {0x3, 0, 0, 0};
  world.angles_rad = {0, 0};
  world.farthest_m = {4, 4};
  const View view = look(world, SE3());
  const BuiltMap built = build_map(world, {view});
  ViewOptions other;
  other.flipped_bits = 12;
  TrackedFrame frame = frame_of(look(world, SE3(), other), 1);
  const LocalMap local = gather_local_map(built.atlas, {}, built.keyframes[0], 80);
  EXPECT_TRUE(search_local_map(built.atlas, local, frame, 3.0, {}).matches.empty());
  MatchLimits any;
  any.ratio = 1.0;
  EXPECT_FALSE(search_local_map(built.atlas, local, frame, 3.0, any).matches.empty());
}

TEST(MatchKeyframe, NeedsNoPose) {
  const Pair pair;
  const View far = look(pair.world, hand_held(1.2, 0.5), noisy_view(3, 20));
  const auto matches = match_keyframe(pair.built.atlas, pair.built.keyframes[0], frame_of(far, 9),
                                      0.75, MatchLimits{});
  expect_one_per_keypoint(matches);
  EXPECT_GT(matches.size(), 100U);
  for (const PointMatch& m : matches) {
    EXPECT_EQ(m.point, pair.built.points[static_cast<std::size_t>(
                           far.shown[static_cast<std::size_t>(m.keypoint)])]);
    EXPECT_LE(m.distance, MatchLimits{}.strict);
  }
}

TEST(MatchKeyframe, SkipsPointsThatAreGoneAndFramesOfElsewhere) {
  Pair pair;
  const KeyFrameId id = pair.built.keyframes[0];
  const View foreign = look(make_world(1200, 77), SE3());
  EXPECT_LT(match_keyframe(pair.built.atlas, id, frame_of(foreign), 0.75, {}).size(), 5U);
  const std::vector<MapPointId> points = pair.built.atlas.at(id).points;
  for (const MapPointId point : points) pair.built.atlas.remove_point(point);
  EXPECT_TRUE(match_keyframe(pair.built.atlas, id, frame_of(pair.next), 0.75, {}).empty());
}

}  // namespace
}  // namespace ydd
