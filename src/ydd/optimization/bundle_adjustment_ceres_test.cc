// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/bundle_adjustment_ceres.h"

#include <gtest/gtest.h>

#include "ydd/optimization/synthetic_scene.h"

namespace ydd {
namespace {

using synthetic::BundleSceneOptions;

struct Case {
  const char* name;
  BundleSceneOptions scene;
};
class OwnAndCeres : public testing::TestWithParam<Case> {};

/// Both are run until nothing moves; then they must agree, for the minimum is one and the same.
TEST_P(OwnAndCeres, FindTheSameSolution) {
  const auto scene = synthetic::make_bundle_scene(GetParam().scene);
  const BundleProblem problem = synthetic::disturbed(scene.truth, 0.01, 0.01, 0.02, 7);
  BundleOptions options;
  options.robust_iterations = options.final_iterations = 200;
  options.relative_decrease = 1e-13;
  const BundleResult own = solve_bundle(scene.camera, problem, options);
  const BundleResult ceres = solve_bundle_ceres(scene.camera, problem, options);
  EXPECT_NEAR(own.initial_cost, ceres.initial_cost, 1e-12 * own.initial_cost);
  EXPECT_LT(own.final_cost, 0.9 * own.initial_cost);
  EXPECT_NEAR(own.final_cost, ceres.final_cost, 1e-6 * ceres.final_cost);
  EXPECT_EQ(own.inlier, ceres.inlier);
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    const SE3 difference = own.T_camera_world[i] * ceres.T_camera_world[i].inverse();
    EXPECT_LT(difference.log().norm(), 1e-4) << "pose " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    BundleAdjustment, OwnAndCeres,
    testing::Values(Case{"Noisy", {.poses = 8, .points = 200}},
                    Case{"AllWithDepth", {.poses = 6, .points = 150, .mono_share = 0.0}},
                    Case{"Outliers", {.poses = 8, .points = 200, .outlier_share = 0.1}},
                    Case{"NoneFixed", {.poses = 6, .points = 150, .fixed_poses = 0}},
                    Case{"LongPath", {.poses = 60, .points = 400, .path_m = 24.0}}),
    [](const auto& c) { return c.param.name; });

TEST(BundleAdjustmentCeres, StopsAtOnce) {
  const auto scene = synthetic::make_bundle_scene({.poses = 4, .points = 50});
  std::stop_source source;
  source.request_stop();
  const BundleResult result =
      solve_bundle_ceres(scene.camera, scene.truth, BundleOptions(), source.get_token());
  EXPECT_TRUE(result.interrupted);
  EXPECT_EQ(result.points, scene.truth.points);
}

}  // namespace
}  // namespace ydd
