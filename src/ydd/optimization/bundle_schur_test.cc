// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/bundle_schur.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "ydd/optimization/synthetic_scene.h"

namespace ydd::bundle {
namespace {

/// The whole damped system, solved without any elimination.
Eigen::VectorXd dense_step(const Layout& layout, const NormalEquations& n,
                           const std::vector<std::uint8_t>& active, double lambda) {
  const int poses = 6 * layout.columns();
  const int size = poses + 3 * layout.points();
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd g(size);
  for (int c = 0; c < layout.columns(); ++c) {
    h.block<6, 6>(6 * c, 6 * c) = n.pose_hessian[c];
    g.segment<6>(6 * c) = n.pose_gradient[c];
  }
  for (int j = 0; j < layout.points(); ++j) {
    const int at = poses + 3 * j;
    h.block<3, 3>(at, at) = n.point_hessian[j];
    g.segment<3>(at) = n.point_gradient[j];
    for (int i = layout.first[j]; i < layout.first[j + 1]; ++i) {
      const int column = layout.entries[i].column;
      if (column < 0 || !active[i]) continue;
      h.block<6, 3>(6 * column, at) += n.coupling[i];
      h.block<3, 6>(at, 6 * column) += n.coupling[i].transpose();
    }
  }
  h.diagonal() *= 1.0 + lambda;
  h.diagonal().array() += 1e-9;
  return -h.ldlt().solve(g);
}

struct Case {
  const char* name;
  synthetic::BundleSceneOptions scene;
  bool seen_twice = false;
};

class SchurStep : public testing::TestWithParam<Case> {};

TEST_P(SchurStep, IsTheStepOfTheWholeSystem) {
  BundleProblem problem = synthetic::make_bundle_scene(GetParam().scene).truth;
  problem = synthetic::disturbed(problem, 0.01, 0.01, 0.02, 3);
  if (GetParam().seen_twice) {
    const auto observations = problem.observations;
    for (std::size_t i = 0; i < observations.size(); i += 3) {
      problem.observations.push_back(observations[i]);
    }
  }
  const Layout layout = make_layout(problem);
  State state;
  for (const auto& pose : problem.poses) state.T_camera_world.push_back(pose.T_camera_world);
  state.points = problem.points;
  std::vector<std::uint8_t> active(layout.entries.size(), 1);
  for (std::size_t i = 0; i < active.size(); i += 9) active[i] = 0;
  const Intrinsics k{Camera()};
  const NormalEquations n = linearise(k, layout, active, state, Loss());
  SchurSolver solver(layout);
  for (const double lambda : {1e-3, 10.0}) {
    const auto step = solver.solve(n, active, lambda, {});
    ASSERT_TRUE(step);
    const Eigen::VectorXd expected = dense_step(layout, n, active, lambda);
    for (int c = 0; c < layout.columns(); ++c) {
      EXPECT_LT((step->poses[c] - expected.segment<6>(6 * c)).norm(), 1e-7 * expected.norm());
    }
    for (int j = 0; j < layout.points(); ++j) {
      const Eigen::Vector3d e = expected.segment<3>(6 * layout.columns() + 3 * j);
      EXPECT_LT((step->points[j] - e).norm(), 1e-7 * expected.norm()) << "point " << j;
    }
    EXPECT_GT(step->predicted_decrease, 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(
    BundleSchur, SchurStep,
    testing::Values(Case{"Small", {.poses = 6, .points = 60}},
                    Case{"SeenTwice", {.poses = 4, .points = 40}, true},
                    Case{"PosesAllFixed", {.poses = 3, .points = 20, .fixed_poses = 3}},
                    Case{"LongPath", {.poses = 60, .points = 100, .path_m = 30.0}}),
    [](const auto& c) { return c.param.name; });

TEST(BundleSchur, GivesNothingWhenTheSystemIsNotFinite) {
  const BundleProblem problem = synthetic::make_bundle_scene({.poses = 4, .points = 30}).truth;
  const Layout layout = make_layout(problem);
  State state;
  for (const auto& pose : problem.poses) state.T_camera_world.push_back(pose.T_camera_world);
  state.points = problem.points;
  const std::vector<std::uint8_t> active(layout.entries.size(), 1);
  NormalEquations n = linearise(Intrinsics(Camera()), layout, active, state, Loss());
  n.pose_hessian[0](2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(SchurSolver(layout).solve(n, active, 1e-4, {}));
}

}  // namespace
}  // namespace ydd::bundle
