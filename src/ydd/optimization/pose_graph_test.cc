// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/pose_graph.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "ydd/optimization/synthetic_scene.h"

namespace ydd {
namespace {

SE3 random_pose(std::mt19937& random, double translation_m, double rotation_rad) {
  return SE3::exp(synthetic::random_twist(random, translation_m, rotation_rad));
}

/// A walk around a circle, looking ahead, that ends where it began.
std::vector<SE3> circle(int count, double radius_m) {
  std::vector<SE3> poses;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    poses.emplace_back(so3_exp(angle * Eigen::Vector3d::UnitZ()),
                       radius_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0));
  }
  return poses;
}

double largest_error(const std::vector<SE3>& poses, const std::vector<SE3>& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    largest = std::max(largest, (poses[i] * truth[i].inverse()).log().norm());
  }
  return largest;
}

Matrix6d information_of(double sigma_m, double sigma_rad) {
  Vector6d diagonal;
  diagonal << Eigen::Vector3d::Constant(1.0 / (sigma_m * sigma_m)),
      Eigen::Vector3d::Constant(1.0 / (sigma_rad * sigma_rad));
  return diagonal.asDiagonal();
}

/// Odometry along `truth` with the given error per step; nodes start where it leads.
PoseGraph odometry_along(const std::vector<SE3>& truth, double error_m, double error_rad,
                         unsigned seed) {
  std::mt19937 random(seed);
  PoseGraph graph;
  graph.nodes.push_back({truth[0], true});
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const SE3 step = truth[i - 1].inverse() * truth[i] * random_pose(random, error_m, error_rad);
    graph.edges.push_back({static_cast<int>(i) - 1, static_cast<int>(i), step,
                           information_of(error_m + 1e-3, error_rad + 1e-3)});
    graph.nodes.push_back({graph.nodes.back().T_world_node * step, false});
  }
  return graph;
}

TEST(PoseGraph, JacobiansMatchNumericDifferences) {
  std::mt19937 random(4);
  for (const double size : {1e-9, 1e-3, 0.1, 1.0}) {  // of the residual
    for (int trial = 0; trial < 10; ++trial) {
      const SE3 T_world_from = random_pose(random, 3.0, 1.0);
      const SE3 T_from_to = random_pose(random, 1.0, 0.5);
      const SE3 T_world_to = T_world_from * T_from_to * random_pose(random, size, size);
      const PoseGraphJacobians j = pose_graph_jacobians(T_world_from, T_world_to, T_from_to);
      for (int axis = 0; axis < 6; ++axis) {
        constexpr double kStep = 1e-6;
        const SE3 forth = SE3::exp(kStep * Vector6d::Unit(axis));
        const SE3 back = SE3::exp(-kStep * Vector6d::Unit(axis));
        const Vector6d by_from = (pose_graph_residual(T_world_from * forth, T_world_to, T_from_to) -
                                  pose_graph_residual(T_world_from * back, T_world_to, T_from_to)) /
                                 (2.0 * kStep);
        const Vector6d by_to = (pose_graph_residual(T_world_from, T_world_to * forth, T_from_to) -
                                pose_graph_residual(T_world_from, T_world_to * back, T_from_to)) /
                               (2.0 * kStep);
        EXPECT_LT((j.by_from.col(axis) - by_from).norm(), 1e-6 * (1.0 + by_from.norm()));
        EXPECT_LT((j.by_to.col(axis) - by_to).norm(), 1e-6 * (1.0 + by_to.norm()));
      }
    }
  }
}

TEST(PoseGraph, AConsistentGraphIsSolvedExactly) {
  const std::vector<SE3> truth = circle(30, 5.0);
  PoseGraph graph = odometry_along(truth, 0.0, 0.0, 1);
  graph.edges.push_back({29, 0, truth[29].inverse() * truth[0], information_of(0.01, 0.01)});
  graph.edges.push_back({3, 20, truth[3].inverse() * truth[20], information_of(0.01, 0.01)});
  std::mt19937 random(2);
  for (auto& node : graph.nodes) {
    if (!node.fixed) node.T_world_node = node.T_world_node * random_pose(random, 0.3, 0.1);
  }
  const PoseGraphResult result = solve_pose_graph(graph, PoseGraphOptions());
  EXPECT_TRUE(result.converged);
  EXPECT_GT(result.initial_cost, 1.0);
  EXPECT_LT(result.final_cost, 1e-12);
  EXPECT_LT(largest_error(result.T_world_node, truth), 1e-7);
}

TEST(PoseGraph, ClosingALoopTakesTheDriftOut) {
  const std::vector<SE3> truth = circle(120, 5.0);
  double before = 0.0;
  double after = 0.0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    PoseGraph graph = odometry_along(truth, 0.01, 0.005, seed);
    std::vector<SE3> drifted;
    for (const auto& node : graph.nodes) drifted.push_back(node.T_world_node);
    graph.edges.push_back({119, 0, truth[119].inverse() * truth[0], information_of(0.001, 0.001)});
    const PoseGraphResult result = solve_pose_graph(graph, PoseGraphOptions());
    EXPECT_TRUE(result.converged);
    EXPECT_LT((result.T_world_node[119] * truth[119].inverse()).log().norm(), 0.02);
    EXPECT_LT(result.final_cost, 0.2 * result.initial_cost);
    before += largest_error(drifted, truth);
    after += largest_error(result.T_world_node, truth);
  }
  EXPECT_LT(after, 0.6 * before);
}

TEST(PoseGraph, AWrongLoopIsHeldBackByTheRobustLoss) {
  const std::vector<SE3> truth = circle(40, 3.0);
  PoseGraph graph = odometry_along(truth, 0.002, 0.001, 5);
  graph.edges.push_back({39, 0, truth[39].inverse() * truth[0], information_of(0.002, 0.002)});
  for (int i = 0; i < 36; i += 4) {  // overlapping views tie the walk together
    graph.edges.push_back(
        {i, i + 3, truth[i].inverse() * truth[i + 3], information_of(0.002, 0.002)});
  }
  graph.edges.push_back({10, 30, SE3(), information_of(0.01, 0.01)});  // two places taken for one
  PoseGraphOptions options;
  const double plain = largest_error(solve_pose_graph(graph, options).T_world_node, truth);
  options.huber_width = 3.0;
  const double robust = largest_error(solve_pose_graph(graph, options).T_world_node, truth);
  EXPECT_GT(plain, 0.5);
  EXPECT_LT(robust, 0.1 * plain);
}

TEST(PoseGraph, FixedAndLonelyNodesStayToTheBit) {
  const std::vector<SE3> truth = circle(12, 2.0);
  PoseGraph graph = odometry_along(truth, 0.05, 0.05, 6);
  graph.nodes[11].fixed = true;
  graph.nodes.push_back({SE3::exp(Vector6d::Constant(0.3)), false});
  const PoseGraphResult result = solve_pose_graph(graph, PoseGraphOptions());
  for (const int i : {0, 11, 12}) {
    EXPECT_EQ(result.T_world_node[i].matrix(), graph.nodes[i].T_world_node.matrix()) << i;
  }
}

TEST(PoseGraph, HoldsTheFirstNodeWhenNoneIsFixed) {
  const std::vector<SE3> truth = circle(10, 2.0);
  PoseGraph graph = odometry_along(truth, 0.0, 0.0, 7);
  graph.nodes[0].fixed = false;
  std::mt19937 random(2);
  for (std::size_t i = 1; i < graph.nodes.size(); ++i) {
    graph.nodes[i].T_world_node = graph.nodes[i].T_world_node * random_pose(random, 0.2, 0.1);
  }
  EXPECT_LT(largest_error(solve_pose_graph(graph, PoseGraphOptions()).T_world_node, truth), 1e-7);
}

TEST(PoseGraph, WeightsMayCoupleOrLeaveDirectionsFree) {
  // Two opinions about one step: the mean weighted by a full, singular and a full, regular matrix.
  std::mt19937 random(8);
  const Matrix6d root = Matrix6d::NullaryExpr(
      [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); });
  Matrix6d singular = root.transpose() * root;
  singular.row(2).setZero();
  singular.col(2).setZero();
  PoseGraph graph;
  graph.nodes = {{SE3(), true}, {SE3(), false}};
  Vector6d a = Vector6d::Zero();
  a.head<3>() << 0.02, -0.01, 5.0;  // its z is not believed
  graph.edges = {{0, 1, SE3::exp(a), singular}, {0, 1, SE3(), 1e-6 * Matrix6d::Identity()}};
  const PoseGraphResult result = solve_pose_graph(graph, PoseGraphOptions());
  const Eigen::Vector3d t = result.T_world_node[1].translation();
  EXPECT_NEAR(t.x(), 0.02, 1e-3);
  EXPECT_NEAR(t.y(), -0.01, 1e-3);
  EXPECT_NEAR(t.z(), 0.0, 1e-3);
  EXPECT_LT(result.final_cost, 1e-6 * a.squaredNorm());
}

TEST(PoseGraph, RefusesBrokenEdges) {
  PoseGraph graph;
  graph.nodes.resize(2);
  graph.edges = {{0, 2, SE3(), Matrix6d::Identity()}};
  EXPECT_THROW(solve_pose_graph(graph, PoseGraphOptions()), std::logic_error);
  graph.edges = {{1, 1, SE3(), Matrix6d::Identity()}};
  EXPECT_THROW(solve_pose_graph(graph, PoseGraphOptions()), std::logic_error);
  graph.edges = {{0, 1, SE3(), -Matrix6d::Identity()}};
  EXPECT_THROW(solve_pose_graph(graph, PoseGraphOptions()), std::logic_error);
  graph.edges = {{0, 1, SE3(), Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN())}};
  EXPECT_THROW(solve_pose_graph(graph, PoseGraphOptions()), std::logic_error);
}

TEST(PoseGraph, StopsAtOnceAndTakesEmptyGraphs) {
  const std::vector<SE3> truth = circle(12, 2.0);
  PoseGraph graph = odometry_along(truth, 0.05, 0.05, 6);
  graph.edges.push_back({11, 0, truth[11].inverse() * truth[0], information_of(0.01, 0.01)});
  std::stop_source source;
  source.request_stop();
  const PoseGraphResult stopped = solve_pose_graph(graph, PoseGraphOptions(), source.get_token());
  EXPECT_TRUE(stopped.interrupted);
  EXPECT_FALSE(stopped.converged);
  EXPECT_EQ(stopped.final_cost, stopped.initial_cost);

  EXPECT_TRUE(solve_pose_graph(PoseGraph(), PoseGraphOptions()).T_world_node.empty());
}

TEST(PoseGraph, TwoCallsGiveTheSameBits) {
  const std::vector<SE3> truth = circle(60, 5.0);
  PoseGraph graph = odometry_along(truth, 0.01, 0.01, 9);
  graph.edges.push_back({59, 0, truth[59].inverse() * truth[0], information_of(0.01, 0.01)});
  const PoseGraphResult a = solve_pose_graph(graph, PoseGraphOptions());
  const PoseGraphResult b = solve_pose_graph(graph, PoseGraphOptions());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_EQ(a.T_world_node[i].matrix(), b.T_world_node[i].matrix());
  }
}

}  // namespace
}  // namespace ydd
