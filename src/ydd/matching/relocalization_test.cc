// SPDX-License-Identifier: Apache-2.0
#include "ydd/matching/relocalization.h"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "ydd/matching/matching_testing.h"

namespace ydd {
namespace {

using testing_world::build_map;
using testing_world::BuiltMap;
using testing_world::frame_of;
using testing_world::hand_held;
using testing_world::look;
using testing_world::make_world;
using testing_world::noisy_view;
using testing_world::PointWorld;
using testing_world::position_error_m;
using testing_world::rotation_error_rad;
using testing_world::View;

struct Known {
  PointWorld world = make_world(1200, 6);
  std::vector<View> views = {look(world, hand_held(0.0), noisy_view(1, 12)),
                             look(world, hand_held(0.5), noisy_view(2, 12)),
                             look(world, hand_held(1.0), noisy_view(3, 12))};
  BuiltMap built = build_map(world, views);
};

std::optional<Relocalization> find(const Known& known, const TrackedFrame& frame,
                                   std::vector<KeyFrameId> candidates) {
  return relocalize(known.built.atlas, frame, candidates, {}, {}, {});
}

/// The view with `share` of its keypoints at random places.
View with_outliers(const View& view, const Camera& camera, double share) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  Features f = view.features();
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (unit(random) > static_cast<float>(share)) continue;
    f.undistorted_px[i] = {unit(random) * static_cast<float>(camera.width_px),
                           unit(random) * static_cast<float>(camera.height_px)};
    f.right_px[i] = -1.0F;
    f.depth_m[i] = 0.0F;
  }
  View out = view;
  out.grid = std::make_shared<const KeypointGrid>(f, camera);
  out.shared_features = std::make_shared<const Features>(std::move(f));
  return out;
}

TEST(Relocalize, FindsThePoseWithoutAnyGuess) {
  const Known known;
  const View view = look(known.world, hand_held(0.7, 0.5), noisy_view(9, 12));
  const auto found = find(known, frame_of(view, 5), known.built.keyframes);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(position_error_m(found->T_camera_world.inverse(), view.T_world_camera), 0.005);
  EXPECT_LT(rotation_error_rad(found->T_camera_world.inverse(), view.T_world_camera), 0.002);
  EXPECT_EQ(found->keyframe, known.built.keyframes[0]);  // the first that will do
  std::set<int> keypoints;
  for (const PointMatch& m : found->inliers) {
    const int shown = view.shown[static_cast<std::size_t>(m.keypoint)];
    EXPECT_EQ(m.point, known.built.points[static_cast<std::size_t>(shown)]);
    EXPECT_TRUE(keypoints.insert(m.keypoint).second);
  }
  EXPECT_GT(keypoints.size(), 100U);
}

TEST(Relocalize, StandsManyWrongMatches) {
  const Known known;
  const View view = with_outliers(look(known.world, hand_held(0.7, 0.5), noisy_view(9, 12)),
                                  known.world.camera, 0.5);
  const auto found = find(known, frame_of(view, 5), known.built.keyframes);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(position_error_m(found->T_camera_world.inverse(), view.T_world_camera), 0.01);
}

TEST(Relocalize, SaysNothingAboutAnUnknownPlace) {
  const Known known;
  const View elsewhere = look(make_world(1200, 70), SE3(), noisy_view(9, 12));
  EXPECT_FALSE(find(known, frame_of(elsewhere), known.built.keyframes).has_value());
  const View known_view = look(known.world, hand_held(0.7), noisy_view(9, 12));
  EXPECT_FALSE(find(known, frame_of(known_view), {}).has_value());
}

TEST(Relocalize, SkipsCandidatesThatAreGone) {
  Known known;
  known.built.atlas.cull_keyframe(known.built.keyframes[1]);
  const View view = look(known.world, hand_held(0.7), noisy_view(9, 12));
  const auto found =
      find(known, frame_of(view), {known.built.keyframes[1], known.built.keyframes[2]});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->keyframe, known.built.keyframes[2]);
}

TEST(Relocalize, IsDeterministicForASeed) {
  const Known known;
  const View view = with_outliers(look(known.world, hand_held(0.7, 0.5), noisy_view(9, 12)),
                                  known.world.camera, 0.4);
  const auto a = find(known, frame_of(view), known.built.keyframes);
  const auto b = find(known, frame_of(view), known.built.keyframes);
  ASSERT_TRUE(a.has_value());
  ASSERT_TRUE(b.has_value());
  EXPECT_EQ(a->T_camera_world.matrix(), b->T_camera_world.matrix());
  EXPECT_EQ(a->inliers.size(), b->inliers.size());
}

}  // namespace
}  // namespace ydd
