// SPDX-License-Identifier: Apache-2.0
// Pose-only optimisation and bundle adjustment; ours beside Ceres on the same problems.
#include <benchmark/benchmark.h>

#include "ydd/optimization/bundle_adjustment.h"
#include "ydd/optimization/bundle_adjustment_ceres.h"
#include "ydd/optimization/pose_only.h"
#include "ydd/optimization/synthetic_scene.h"

namespace {

using ydd::BundleOptions;
using ydd::BundleProblem;
using ydd::BundleResult;
using ydd::synthetic::BundleScene;
using ydd::synthetic::BundleSceneOptions;

void pose_only(benchmark::State& state) {
  const auto scene = ydd::synthetic::make_pose_scene(
      {.observations = static_cast<int>(state.range(0)),
       .outlier_share = 0.01 * static_cast<double>(state.range(1))});
  std::mt19937 random(7);
  const ydd::SE3 start =
      ydd::SE3::exp(ydd::synthetic::random_twist(random, 0.03, 0.03)) * scene.T_camera_world;
  int inliers = 0;
  for (auto _ : state) {
    const auto result =
        ydd::optimize_pose(scene.camera, start, scene.observations, ydd::PoseOnlyOptions());
    inliers = result.inliers;
  }
  state.counters["inliers"] = inliers;
}
BENCHMARK(pose_only)
    ->ArgNames({"observations", "outliers_percent"})
    ->ArgsProduct({{100, 300, 1000}, {5, 30}})
    ->Unit(benchmark::kMicrosecond);

/// 0: 20 poses, 2000 points, about 10 000 observations. 1: 60 poses, 4000 points. 2: the whole of a
/// long walk, 400 poses, 20 000 points. 3: 400 poses around a room, everything seen from
/// everywhere.
BundleSceneOptions size_of(std::int64_t size) {
  switch (size) {
    case 0:
      return {
          .poses = 20, .points = 2000, .fixed_poses = 4, .outlier_share = 0.02, .most_views = 5};
    case 1:
      return {.poses = 60,
              .points = 4000,
              .fixed_poses = 10,
              .outlier_share = 0.02,
              .most_views = 12,
              .path_m = 6.0};
    case 2:
      return {
          .poses = 400, .points = 20000, .outlier_share = 0.02, .most_views = 30, .path_m = 100.0};
    default:
      return {.poses = 300, .points = 6000, .outlier_share = 0.02, .most_views = 40, .path_m = 3.0};
  }
}

template <class Solve>
void bundle(benchmark::State& state, Solve solve) {
  const BundleScene scene = ydd::synthetic::make_bundle_scene(size_of(state.range(0)));
  const BundleProblem problem = ydd::synthetic::disturbed(scene.truth, 0.01, 0.01, 0.03, 7);
  BundleResult result;
  for (auto _ : state) result = solve(scene.camera, problem);
  state.counters["observations"] = static_cast<double>(problem.observations.size());
  state.counters["iterations"] = result.iterations;
  state.counters["final_cost"] = result.final_cost;
}
BENCHMARK_CAPTURE(bundle, own, [](const auto&... a) {
  return ydd::solve_bundle(a..., BundleOptions());
}) -> ArgName("size") -> DenseRange(0, 3) -> Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bundle, ceres, [](const auto&... a) {
  return ydd::solve_bundle_ceres(a..., BundleOptions());
}) -> ArgName("size") -> DenseRange(0, 3) -> Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
