// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/local_bundle.h"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/matching/matching_testing.h"

namespace ydd {
namespace {

using testing::IsEmpty;
using testing_world::build_map;
using testing_world::BuiltMap;
using testing_world::hand_held;
using testing_world::look;
using testing_world::make_world;
using testing_world::PointWorld;
using testing_world::position_error_m;
using testing_world::View;
using testing_world::ViewOptions;

struct DisturbedScene {
  PointWorld world = make_world(500, 41);
  std::vector<View> views;
  BuiltMap built;

  explicit DisturbedScene(int keyframes)
      : views(look_around(keyframes)), built(build_map(world, views)) {}

  std::vector<View> look_around(int keyframes) const {
    std::vector<View> out;
    for (int i = 0; i < keyframes; ++i) {
      ViewOptions options;
      options.noise_px = 0.3;
      options.depth_noise = 0.001;
      options.seed = static_cast<unsigned>(i);
      out.push_back(look(world, hand_held(0.3 * i), options));
    }
    return out;
  }
  /// Moves all but the first keyframe, and all points, by a few centimetres.
  void disturb() {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (std::size_t i = 1; i < built.keyframes.size(); ++i) {
      Vector6d twist;
      for (int k = 0; k < 6; ++k) twist[k] = (k < 3 ? 0.02 : 0.005) * normal(random);
      built.atlas.set_pose(built.keyframes[i], views[i].T_world_camera * SE3::exp(twist));
    }
    for (const MapPointId id : built.atlas.points().ids()) {
      const double z = normal(random), y = normal(random);
      const Eigen::Vector3d shift(normal(random), y, z);
      built.atlas.set_position(id, built.atlas.at(id).p_world + 0.03 * shift);
    }
  }
  double pose_error_m() const {
    double worst = 0;
    for (std::size_t i = 0; i < built.keyframes.size(); ++i) {
      worst = std::max(worst, position_error_m(built.atlas.at(built.keyframes[i]).T_world_camera,
                                               views[i].T_world_camera));
    }
    return worst;
  }
  std::size_t links() const {
    std::size_t links = 0;
    built.atlas.points().for_each(
        [&](MapPointId, const MapPoint& point) { links += point.observations.size(); });
    return links;
  }
  double point_error_m() const {
    std::vector<double> errors;
    for (std::size_t i = 0; i < built.points.size(); ++i) {
      const MapPoint* point = built.atlas.find(built.points[i]);
      if (point) errors.push_back((point->p_world - world.p_world[i]).norm());
    }
    std::sort(errors.begin(), errors.end());
    return errors.at(errors.size() / 2);
  }
};

TEST(GatherLocalBundle, NamesEveryPoseAndPointAndAllTheirSightings) {
  DisturbedScene scene(6);
  const Atlas& atlas = scene.built.atlas;
  const GatheredBundle g = gather_local_bundle(atlas, scene.built.keyframes[5], {});
  ASSERT_EQ(g.keyframes.size(), g.problem.poses.size());
  ASSERT_EQ(g.points.size(), g.problem.points.size());
  EXPECT_EQ(g.keyframes.front(), scene.built.keyframes[5]);
  EXPECT_EQ(g.keyframes.size(), 6U);
  std::size_t observations = 0;
  for (std::size_t p = 0; p < g.points.size(); ++p) {
    EXPECT_EQ(g.problem.points[p], atlas.at(g.points[p]).p_world);
    observations += atlas.at(g.points[p]).observations.size();
  }
  EXPECT_EQ(g.problem.observations.size(), observations);
  for (std::size_t i = 0; i < g.keyframes.size(); ++i) {
    EXPECT_EQ(g.problem.poses[i].fixed, g.keyframes[i] == scene.built.keyframes[0]);
  }
  for (const BundleProblem::Observation& o : g.problem.observations) {
    const KeyFrame& keyframe = atlas.at(g.keyframes[static_cast<std::size_t>(o.pose)]);
    const MapPointId id = g.points[static_cast<std::size_t>(o.point)];
    const auto k = std::find(keyframe.points.begin(), keyframe.points.end(), id);
    ASSERT_NE(k, keyframe.points.end());
    EXPECT_EQ(o.uvr_px, uvr_px(keyframe.features(), static_cast<int>(k - keyframe.points.begin())));
  }
}

TEST(GatherLocalBundle, IsLimitedAndTheRestHoldsStill) {
  DisturbedScene scene(8);
  LocalBundleOptions options;
  options.max_free_keyframes = 3;
  options.max_fixed_keyframes = 2;
  const GatheredBundle g =
      gather_local_bundle(scene.built.atlas, scene.built.keyframes[7], options);
  const auto fixed = std::count_if(g.problem.poses.begin(), g.problem.poses.end(),
                                   [](const auto& pose) { return pose.fixed; });
  EXPECT_EQ(g.keyframes.size(), 5U);
  EXPECT_GE(fixed, 2);
  auto sorted = g.keyframes;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end()) << "a keyframe twice";
}

TEST(GatherLocalBundle, SomeoneAlwaysHoldsTheFrameOfReference) {
  // Two keyframes that do not see what the first one sees.
  const PointWorld world = make_world(600, 41);
  std::vector<View> views;
  for (const int from : {0, 300, 300}) {
    ViewOptions options;
    options.from_point = from;
    options.points = 300;
    views.push_back(look(world, hand_held(0.001 * from), options));
  }
  BuiltMap built = build_map(world, views);
  built.atlas.set_parent(built.keyframes[1], built.keyframes[0]);
  const GatheredBundle g = gather_local_bundle(built.atlas, built.keyframes[2], {});
  ASSERT_EQ(g.keyframes.size(), 2U);
  EXPECT_FALSE(g.problem.poses[0].fixed);
  EXPECT_TRUE(g.problem.poses[1].fixed);
}

TEST(LocalBundle, BringsADisturbedMapBack) {
  DisturbedScene scene(6);
  scene.disturb();
  EXPECT_GT(scene.pose_error_m(), 0.02);
  const double points_before_m = scene.point_error_m();
  const std::size_t links_before = scene.links();
  ASSERT_GT(links_before, 500U);
  const GatheredBundle g = gather_local_bundle(scene.built.atlas, scene.built.keyframes[5], {});
  const BundleResult solved = solve_bundle(scene.built.atlas.camera(), g.problem, {});
  apply_bundle(scene.built.atlas, g, solved);
  EXPECT_LT(solved.final_cost, 0.1 * solved.initial_cost);
  EXPECT_LT(scene.pose_error_m(), 0.004);
  EXPECT_LT(scene.point_error_m(), 0.5 * points_before_m);
  // All are right: what was out of place must not be taken for outliers.
  EXPECT_GE(scene.links(), links_before * 98 / 100);
  EXPECT_THAT(scene.built.atlas.check_consistency(), IsEmpty());
}

TEST(LocalBundle, UnlinksOutliers) {
  DisturbedScene scene(6);
  Atlas& atlas = scene.built.atlas;
  // Two points of keyframe 3 change places: both observations are wrong.
  const KeyFrameId id = scene.built.keyframes[3];
  const MapPointId a = atlas.at(id).points[0];
  const MapPointId b = atlas.at(id).points[9];
  ASSERT_GE(atlas.at(a).observations.size(), 3U);
  ASSERT_GE(atlas.at(b).observations.size(), 3U);
  atlas.remove_observation(a, id);
  atlas.remove_observation(b, id);
  ASSERT_TRUE(atlas.add_observation(a, id, 9));
  ASSERT_TRUE(atlas.add_observation(b, id, 0));
  const std::size_t links_before = scene.links();
  const GatheredBundle g = gather_local_bundle(atlas, scene.built.keyframes[5], {});
  apply_bundle(atlas, g, solve_bundle(atlas.camera(), g.problem, {}));
  EXPECT_FALSE(atlas.at(id).points[0].valid());
  EXPECT_FALSE(atlas.at(id).points[9].valid());
  EXPECT_NE(atlas.find(a), nullptr);
  EXPECT_NE(atlas.find(b), nullptr);
  EXPECT_EQ(scene.links(), links_before - 2) << "the two that are wrong, and no other";
  EXPECT_THAT(atlas.check_consistency(), IsEmpty());
}

}  // namespace
}  // namespace ydd
