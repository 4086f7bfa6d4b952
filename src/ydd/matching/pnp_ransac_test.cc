// SPDX-License-Identifier: Apache-2.0
#include "ydd/matching/pnp_ransac.h"

#include <random>

#include <gtest/gtest.h>

#include "ydd/matching/matching_testing.h"

namespace ydd {
namespace {

using testing_world::hand_held;
using testing_world::look;
using testing_world::make_world;
using testing_world::PointWorld;
using testing_world::position_error_m;
using testing_world::rotation_error_rad;
using testing_world::View;

struct Scene {
  PointWorld world = make_world(1200, 6);
  View view = look(world, hand_held(0.7), {.noise_px = 0.5, .seed = 3});

  /// Right matches, `outlier_share` of them with a point of somewhere else.
  std::vector<PointMatch> matches(double outlier_share) const {
    std::mt19937 random(9);
    std::vector<PointMatch> out;
    for (std::size_t k = 0; k < view.shown.size() && out.size() < 200; ++k) {
      const bool wrong = static_cast<double>(random() % 1000U) < 1000 * outlier_share;
      const std::size_t point =
          wrong ? random() % world.p_world.size() : static_cast<std::size_t>(view.shown[k]);
      out.push_back({static_cast<int>(k), world.p_world[point], {}, 0, 0});
    }
    return out;
  }
  std::optional<SE3> solve(double outlier_share, unsigned seed) const {
    return pnp_ransac(world.camera, view.features(), matches(outlier_share), {500, 4.0, seed});
  }
};

TEST(PnpRansac, FindsThePoseAmongOutliers) {
  const Scene scene;
  for (const double share : {0.0, 0.3, 0.5, 0.7}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      const auto T_camera_world = scene.solve(share, seed);
      ASSERT_TRUE(T_camera_world.has_value()) << share;
      EXPECT_LT(position_error_m(T_camera_world->inverse(), scene.view.T_world_camera), 0.1)
          << share << ", seed " << seed;
      EXPECT_LT(rotation_error_rad(T_camera_world->inverse(), scene.view.T_world_camera), 0.05);
    }
  }
}

TEST(PnpRansac, EqualSeedsAgreeAndOthersDoNot) {
  const Scene scene;
  const auto a = scene.solve(0.5, 1);
  const auto again = scene.solve(0.5, 1);
  const auto b = scene.solve(0.5, 2);
  ASSERT_TRUE(a && again && b);
  EXPECT_EQ(a->matrix(), again->matrix());
  EXPECT_NE(a->matrix(), b->matrix());
}

TEST(PnpRansac, NoConsensusIsNoPose) {
  const Scene scene;
  std::vector<PointMatch> few = scene.matches(0.0);
  few.resize(3);
  EXPECT_FALSE(pnp_ransac(scene.world.camera, scene.view.features(), few, {}).has_value());
}

}  // namespace
}  // namespace ydd
