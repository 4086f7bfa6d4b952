// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/bundle_linearise.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "ydd/optimization/synthetic_scene.h"

namespace ydd::bundle {
namespace {

struct Fixture {
  synthetic::BundleScene scene;
  BundleProblem problem;
  Layout layout;
  State state;
  std::vector<std::uint8_t> active;
  Intrinsics k;
};

Fixture make_fixture(const synthetic::BundleSceneOptions& options) {
  Fixture f{synthetic::make_bundle_scene(options), {}, {}, {}, {}, Intrinsics(Camera())};
  f.problem = synthetic::disturbed(f.scene.truth, 0.01, 0.01, 0.02, 3);
  f.layout = make_layout(f.problem);
  for (const auto& pose : f.problem.poses) f.state.T_camera_world.push_back(pose.T_camera_world);
  f.state.points = f.problem.points;
  f.active.assign(f.layout.entries.size(), 1);
  for (std::size_t i = 0; i < f.active.size(); i += 7) f.active[i] = 0;
  f.k = Intrinsics(f.scene.camera);
  return f;
}

double cost_with_pose_moved(const Fixture& f, const Loss& loss, int pose, const Vector6d& twist) {
  State moved = f.state;
  moved.T_camera_world[pose] = SE3::exp(twist) * moved.T_camera_world[pose];
  return cost_of(f.k, f.layout, f.active, moved, loss);
}

double cost_with_point_moved(const Fixture& f, const Loss& loss, int point,
                             const Eigen::Vector3d& by) {
  State moved = f.state;
  moved.points[point] += by;
  return cost_of(f.k, f.layout, f.active, moved, loss);
}

class Gradient : public testing::TestWithParam<bool> {};

TEST_P(Gradient, MatchesNumericDifferencesOfTheCost) {
  const Fixture f = make_fixture({.poses = 4, .points = 25, .outlier_share = 0.2});
  const Loss loss{5.991, 7.815, GetParam()};
  const NormalEquations n = linearise(f.k, f.layout, f.active, f.state, loss);
  EXPECT_NEAR(n.cost, cost_of(f.k, f.layout, f.active, f.state, loss), 1e-9 * n.cost);
  constexpr double kStep = 1e-6;
  for (int c = 0; c < f.layout.columns(); ++c) {
    for (int axis = 0; axis < 6; ++axis) {
      const Vector6d twist = kStep * Vector6d::Unit(axis);
      const int pose = f.layout.pose_of_column[c];
      const double numeric = (cost_with_pose_moved(f, loss, pose, twist) -
                              cost_with_pose_moved(f, loss, pose, -twist)) /
                             (2.0 * kStep);
      EXPECT_NEAR(n.pose_gradient[c][axis], numeric, 1e-6 * n.pose_gradient[c].norm());
    }
  }
  for (int j = 0; j < f.layout.points(); ++j) {
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d by = kStep * Eigen::Vector3d::Unit(axis);
      const double numeric =
          (cost_with_point_moved(f, loss, j, by) - cost_with_point_moved(f, loss, j, -by)) /
          (2.0 * kStep);
      EXPECT_NEAR(n.point_gradient[j][axis], numeric, 1e-6 * (n.point_gradient[j].norm() + 1e3));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BundleLinearise, Gradient, testing::Bool(),
                         [](const auto& huber) { return huber.param ? "Huber" : "Squares"; });

TEST(BundleLinearise, BlocksAreTheProductsOfTheJacobians) {
  const Fixture f = make_fixture({.poses = 3, .points = 12});
  const NormalEquations n = linearise(f.k, f.layout, f.active, f.state, {5.991, 7.815, false});
  std::vector<Matrix6d> pose(f.layout.columns(), Matrix6d::Zero());
  for (int j = 0; j < f.layout.points(); ++j) {
    Eigen::Matrix3d point = Eigen::Matrix3d::Zero();
    for (int i = f.layout.first[j]; i < f.layout.first[j + 1]; ++i) {
      if (!f.active[i]) continue;
      const Layout::Entry& e = f.layout.entries[i];
      const SE3& T = f.state.T_camera_world[e.pose];
      const Eigen::Vector3d p = T * f.state.points[j];
      auto by_pose = twist_jacobian(Reprojection<double>(f.k, p.x(), p.y(), p.z()));
      if (!e.stereo) by_pose.row(2).setZero();
      const Eigen::Matrix3d by_point = by_pose.leftCols<3>() * T.rotation_matrix();
      point += e.inv_sigma2 * by_point.transpose() * by_point;
      if (e.column < 0) continue;
      pose[e.column] += e.inv_sigma2 * by_pose.transpose() * by_pose;
      const Matrix63d coupling = e.inv_sigma2 * by_pose.transpose() * by_point;
      EXPECT_LT((coupling - n.coupling[i]).norm(), 1e-9 * coupling.norm());
    }
    EXPECT_LT((point - n.point_hessian[j]).norm(), 1e-9 * (1.0 + point.norm()));
  }
  for (int c = 0; c < f.layout.columns(); ++c) {
    EXPECT_LT((pose[c] - n.pose_hessian[c]).norm(), 1e-9 * pose[c].norm());
  }
}

TEST(BundleLinearise, LayoutSortsByPointThenPose) {
  BundleProblem problem;
  problem.poses.resize(3);
  problem.poses[1].fixed = true;
  problem.points.assign(3, Eigen::Vector3d(0, 0, 1));
  const Eigen::Vector3d uvr(320, 240, -1);
  problem.observations = {{2, 2, uvr, 1}, {1, 0, uvr, 1}, {0, 2, uvr, 1}, {0, 0, uvr, 1}};
  const Layout layout = make_layout(problem);
  EXPECT_EQ(layout.first, (std::vector<int>{0, 2, 2, 4}));
  EXPECT_EQ(layout.pose_of_column, (std::vector<int>{0, 2}));
  std::vector<int> sources;
  std::vector<int> columns;
  for (const auto& e : layout.entries) {
    sources.push_back(e.source);
    columns.push_back(e.column);
  }
  EXPECT_EQ(sources, (std::vector<int>{3, 1, 2, 0}));
  EXPECT_EQ(columns, (std::vector<int>{0, -1, 0, 1}));
}

TEST(BundleLinearise, HoldsTheFirstPoseWhenNoneIsFixed) {
  BundleProblem problem;
  problem.poses.resize(3);
  EXPECT_EQ(make_layout(problem).pose_of_column, (std::vector<int>{1, 2}));
}

TEST(BundleLinearise, RefusesIndicesThatAreNotThere) {
  BundleProblem problem;
  problem.poses.resize(1);
  problem.points.resize(1, Eigen::Vector3d::Zero());
  problem.observations = {{0, 1, Eigen::Vector3d::Zero(), 1.0}};
  EXPECT_THROW(make_layout(problem), std::logic_error);
  problem.observations = {{-1, 0, Eigen::Vector3d::Zero(), 1.0}};
  EXPECT_THROW(make_layout(problem), std::logic_error);
}

TEST(BundleLinearise, JudgesPointsBehindTheCameraAsOutliers) {
  BundleProblem problem;
  problem.poses.resize(1);
  problem.points = {{0, 0, 2}, {0, 0, -2}};
  const Eigen::Vector3d centre(319.5, 239.5, -1);
  problem.observations = {{0, 0, centre, 1.0}, {0, 1, centre, 1.0}};
  const Layout layout = make_layout(problem);
  const State state{{SE3()}, problem.points};
  EXPECT_EQ(judge(Intrinsics(Camera()), layout, state, Loss()), (std::vector<std::uint8_t>{1, 0}));
}

}  // namespace
}  // namespace ydd::bundle
