// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/bundle_adjustment.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stop_token>
#include <thread>

#include <gtest/gtest.h>

#include "ydd/optimization/synthetic_scene.h"

namespace ydd {
namespace {

using synthetic::BundleScene;
using synthetic::BundleSceneOptions;
using synthetic::make_bundle_scene;

double largest_pose_error(const BundleResult& result, const BundleProblem& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    const SE3 error = result.T_camera_world[i] * truth.poses[i].T_camera_world.inverse();
    largest = std::max(largest, error.log().norm());
  }
  return largest;
}

/// Over points whose place the observations fix: a depth reading, or two views.
double largest_point_error(const BundleResult& result, const BundleProblem& truth) {
  std::vector<int> views(truth.points.size(), 0);
  for (const auto& o : truth.observations) views[o.point] += o.uvr_px.z() >= 0.0 ? 2 : 1;
  double largest = 0.0;
  for (std::size_t j = 0; j < truth.points.size(); ++j) {
    if (views[j] < 2) continue;
    largest = std::max(largest, (result.points[j] - truth.points[j]).norm());
  }
  return largest;
}

int inliers_of(const BundleResult& result) {
  return static_cast<int>(std::count(result.inlier.begin(), result.inlier.end(), 1));
}

BundleOptions patient() {
  BundleOptions options;
  options.robust_iterations = 30;
  options.final_iterations = 30;
  return options;
}

struct NoiseFreeCase {
  const char* name;
  BundleSceneOptions scene;
};
class NoiseFreeBundle : public testing::TestWithParam<NoiseFreeCase> {};

TEST_P(NoiseFreeBundle, ReturnsToTheTruth) {
  const BundleScene scene = make_bundle_scene(GetParam().scene);
  const BundleProblem problem = synthetic::disturbed(scene.truth, 0.02, 0.02, 0.05, 7);
  const BundleResult result = solve_bundle(scene.camera, problem, patient());
  EXPECT_LT(largest_pose_error(result, scene.truth), 1e-6);
  EXPECT_LT(largest_point_error(result, scene.truth), 1e-4);
  EXPECT_GT(result.initial_cost, 100.0);
  EXPECT_LT(result.final_cost, 1e-9);
  EXPECT_EQ(inliers_of(result), static_cast<int>(problem.observations.size()));
  EXPECT_FALSE(result.interrupted);
}

INSTANTIATE_TEST_SUITE_P(
    BundleAdjustment, NoiseFreeBundle,
    testing::Values(NoiseFreeCase{"Mixed", {.noise = 0.0}},
                    NoiseFreeCase{"AllWithDepth", {.noise = 0.0, .mono_share = 0.0}},
                    NoiseFreeCase{"HardlyAnyDepth",
                                  {.poses = 5, .points = 100, .noise = 0.0, .mono_share = 0.9}},
                    NoiseFreeCase{"LongPath",
                                  {.poses = 80, .points = 600, .noise = 0.0, .path_m = 30.0}}),
    [](const auto& c) { return c.param.name; });

TEST(BundleAdjustment, KeepsFixedPosesToTheBit) {
  const BundleScene scene = make_bundle_scene({.poses = 8, .fixed_poses = 3});
  const BundleProblem problem = synthetic::disturbed(scene.truth, 0.02, 0.02, 0.05, 7);
  const BundleResult result = solve_bundle(scene.camera, problem, BundleOptions());
  for (int i = 0; i < 8; ++i) {
    const bool same = result.T_camera_world[i].matrix() == problem.poses[i].T_camera_world.matrix();
    EXPECT_EQ(same, i < 3) << "pose " << i;
  }
}

TEST(BundleAdjustment, HoldsTheFirstPoseWhenNoneIsFixed) {
  const BundleScene scene = make_bundle_scene({.poses = 5, .fixed_poses = 0, .noise = 0.0});
  BundleProblem problem = synthetic::disturbed(scene.truth, 0.02, 0.02, 0.05, 7);
  problem.poses[0] = scene.truth.poses[0];
  const BundleResult result = solve_bundle(scene.camera, problem, patient());
  EXPECT_EQ(result.T_camera_world[0].matrix(), problem.poses[0].T_camera_world.matrix());
  EXPECT_LT(largest_pose_error(result, scene.truth), 1e-6);
}

TEST(BundleAdjustment, SetsOutliersAside) {
  const BundleScene scene = make_bundle_scene({.poses = 12, .points = 500, .outlier_share = 0.1});
  const BundleProblem problem = synthetic::disturbed(scene.truth, 0.01, 0.01, 0.02, 7);
  const BundleResult result = solve_bundle(scene.camera, problem, patient());
  int outliers = 0;
  int accepted = 0;
  int refused = 0;
  for (std::size_t i = 0; i < scene.is_outlier.size(); ++i) {
    outliers += scene.is_outlier[i] ? 1 : 0;
    accepted += scene.is_outlier[i] && result.inlier[i] ? 1 : 0;
    refused += !scene.is_outlier[i] && !result.inlier[i] ? 1 : 0;
  }
  EXPECT_LT(accepted, 0.02 * outliers);
  EXPECT_LT(refused, 0.10 * static_cast<double>(scene.is_outlier.size() - outliers));
  EXPECT_LT(largest_pose_error(result, scene.truth), 0.05);
}

TEST(BundleAdjustment, ResidualsAreAsLargeAsTheNoise) {
  const BundleScene scene = make_bundle_scene({.poses = 10, .points = 600, .mono_share = 0.0});
  BundleOptions options = patient();
  options.chi2_mono = options.chi2_stereo = 1000.0;  // nothing is cut off
  const BundleResult result =
      solve_bundle(scene.camera, synthetic::disturbed(scene.truth, 0.01, 0.01, 0.02, 7), options);
  int rows = 0;
  for (const auto& o : scene.truth.observations) rows += o.uvr_px.z() >= 0.0 ? 3 : 2;
  const int unknowns = 6 * 8 + 3 * 600;
  EXPECT_NEAR(2.0 * result.final_cost / (rows - unknowns), 1.0, 0.05);
}

TEST(BundleAdjustment, StopsAtOnceWithTheBestState) {
  const BundleScene scene = make_bundle_scene({.poses = 6, .points = 100});
  const BundleProblem problem = synthetic::disturbed(scene.truth, 0.01, 0.01, 0.02, 7);
  std::stop_source source;
  source.request_stop();
  const BundleResult result =
      solve_bundle(scene.camera, problem, BundleOptions(), source.get_token());
  EXPECT_TRUE(result.interrupted);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.final_cost, result.initial_cost);
  EXPECT_EQ(result.points, problem.points);
  EXPECT_EQ(result.inlier.size(), problem.observations.size());
}

TEST(BundleAdjustment, StopsHalfwayWithABetterStateThanBefore) {
  const BundleScene scene = make_bundle_scene({.poses = 60, .points = 2000, .path_m = 6.0});
  const BundleProblem problem = synthetic::disturbed(scene.truth, 0.05, 0.05, 0.2, 7);
  std::stop_source source;
  const std::jthread interrupter([&source] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    source.request_stop();
  });
  const BundleResult result = solve_bundle(scene.camera, problem, patient(), source.get_token());
  EXPECT_LE(result.final_cost, result.initial_cost);
  EXPECT_EQ(result.points.size(), problem.points.size());
}

TEST(BundleAdjustment, DegenerateProblemsComeBackAsTheyAre) {
  const BundleResult empty = solve_bundle(Camera(), BundleProblem(), BundleOptions());
  EXPECT_TRUE(empty.points.empty());
  EXPECT_EQ(empty.final_cost, 0.0);

  BundleProblem unseen;
  unseen.poses.resize(3);
  unseen.points = {{1, 2, 3}};
  const BundleResult still = solve_bundle(Camera(), unseen, BundleOptions());
  EXPECT_EQ(still.points, unseen.points);
  EXPECT_EQ(still.T_camera_world[2].matrix(), SE3().matrix());
}

TEST(BundleAdjustment, PointSeenOnceWithoutDepthKeepsItsDistance) {
  BundleScene scene =
      make_bundle_scene({.poses = 4, .points = 80, .noise = 0.0, .mono_share = 0.0});
  scene.truth.points.emplace_back(0.0, 0.0, 3.0);
  const Eigen::Vector3d p_camera = scene.truth.poses[3].T_camera_world * scene.truth.points.back();
  const Eigen::Vector2d px = scene.camera.project(p_camera) + Eigen::Vector2d(4.0, -3.0);
  scene.truth.observations.push_back({3, 80, {px.x(), px.y(), -1.0}, 1.0});
  const BundleResult result = solve_bundle(scene.camera, scene.truth, patient());
  const Eigen::Vector3d moved = result.T_camera_world[3] * result.points.back();
  EXPECT_LT((scene.camera.project(moved) - px).norm(), 1e-4);
  EXPECT_NEAR(moved.z(), p_camera.z(), 0.05);
  EXPECT_LT((result.points[0] - scene.truth.points[0]).norm(), 1e-6);
}

TEST(BundleAdjustment, UnusableObservationsDoNoHarm) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  BundleScene scene = make_bundle_scene({.poses = 5, .points = 100, .noise = 0.0});
  BundleProblem problem = synthetic::disturbed(scene.truth, 0.01, 0.01, 0.02, 7);
  problem.observations[10].uvr_px.x() = kNan;
  problem.observations[20].inv_sigma2 = 0.0;
  problem.points.emplace_back(kNan, 0.0, 1.0);
  problem.observations.push_back({1, 100, {100, 100, 90}, 1.0});
  problem.points.emplace_back(scene.truth.poses[0].T_camera_world.inverse() *
                              Eigen::Vector3d(0.1, 0.1, -2.0));  // behind
  problem.observations.push_back({0, 101, {300, 200, -1}, 1.0});
  const BundleResult result = solve_bundle(scene.camera, problem, patient());
  EXPECT_LT(largest_pose_error(result, scene.truth), 1e-6);
  EXPECT_EQ(inliers_of(result), static_cast<int>(problem.observations.size()) - 4);
  EXPECT_TRUE(std::isfinite(result.initial_cost));
}

TEST(BundleAdjustment, TwoCallsGiveTheSameBits) {
  for (const int poses : {8, 100}) {
    const BundleScene scene = make_bundle_scene(
        {.poses = poses, .points = 300, .outlier_share = 0.05, .path_m = 0.3 * poses});
    const BundleProblem problem = synthetic::disturbed(scene.truth, 0.01, 0.01, 0.02, 7);
    const BundleResult a = solve_bundle(scene.camera, problem, BundleOptions());
    const BundleResult b = solve_bundle(scene.camera, problem, BundleOptions());
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.inlier, b.inlier);
    EXPECT_EQ(a.final_cost, b.final_cost);
    EXPECT_EQ(a.T_camera_world.back().matrix(), b.T_camera_world.back().matrix());
  }
}

}  // namespace
}  // namespace ydd
