// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/pose_graph.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <ceres/ceres.h>
#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "ydd/geometry/se3_jacobians.h"
#include "ydd/optimization/ceres_support.h"

namespace ydd {
namespace {

/// A matrix W with W' W = information. LDL' and not LL': a weight may leave directions free.
Matrix6d weight_of(const Matrix6d& information) {
  const Eigen::LDLT<Matrix6d> ldlt(information);
  const Vector6d d = ldlt.vectorD();
  const bool good = information.allFinite() && ldlt.info() == Eigen::Success &&
                    d.minCoeff() >= -1e-9 * d.cwiseAbs().maxCoeff();
  if (!good) {
    throw std::logic_error("pose graph: the information of an edge is not positive semidefinite");
  }
  const Matrix6d permutation = ldlt.transpositionsP() * Matrix6d::Identity();
  const Matrix6d upper = ldlt.matrixU() * permutation;
  return d.cwiseMax(0.0).cwiseSqrt().asDiagonal() * upper;
}

class EdgeCost : public ceres::SizedCostFunction<6, PoseBlock::kSize, PoseBlock::kSize> {
 public:
  explicit EdgeCost(const PoseGraph::Edge& edge)
      : T_from_to_(edge.T_from_to), weight_(weight_of(edge.information)) {}

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const SE3 T_world_from = PoseBlock::to_se3(parameters[0]);
    const SE3 T_world_to = PoseBlock::to_se3(parameters[1]);
    Eigen::Map<Vector6d> weighted(residuals);
    weighted = weight_ * pose_graph_residual(T_world_from, T_world_to, T_from_to_);
    if (!jacobians) return true;
    const auto [by_from, by_to] = pose_graph_jacobians(T_world_from, T_world_to, T_from_to_);
    write(jacobians[0], by_from);
    write(jacobians[1], by_to);
    return true;
  }

 private:
  void write(double* jacobian, const Matrix6d& by_twist) const {
    if (!jacobian) return;
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> j(jacobian);
    j.leftCols<6>() = weight_ * by_twist;
    j.col(6).setZero();
  }

  SE3 T_from_to_;
  Matrix6d weight_;
};

void check(const PoseGraph& graph) {
  const int nodes = static_cast<int>(graph.nodes.size());
  for (const PoseGraph::Edge& e : graph.edges) {
    if (e.from < 0 || e.from >= nodes || e.to < 0 || e.to >= nodes || e.from == e.to) {
      throw std::logic_error(fmt::format("pose graph: edge from node {} to node {}, there are {}",
                                         e.from, e.to, nodes));
    }
  }
}

double cost_of(const PoseGraph& graph, const std::vector<SE3>& T_world_node, double huber_width) {
  const double gate = huber_width * huber_width;
  double rho = 0.0;
  for (const PoseGraph::Edge& e : graph.edges) {
    const Vector6d r = pose_graph_residual(T_world_node[e.from], T_world_node[e.to], e.T_from_to);
    const double squared = r.dot(e.information * r);
    const bool outside = huber_width > 0.0 && squared > gate;
    rho += outside ? 2.0 * huber_width * std::sqrt(squared) - gate : squared;
  }
  return 0.5 * rho;
}

ceres::Problem::Options problem_options() {
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

ceres::Solver::Options solver_options(const PoseGraphOptions& options) {
  ceres::Solver::Options out;
  out.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  out.num_threads = 1;
  out.max_num_iterations = options.iterations;
  out.function_tolerance = options.relative_decrease;
  out.parameter_tolerance = 1e-14;
  out.gradient_tolerance = 1e-12;
  out.logging_type = ceres::SILENT;
  return out;
}

bool none_fixed(const PoseGraph& graph) {
  return std::none_of(graph.nodes.begin(), graph.nodes.end(),
                      [](const PoseGraph::Node& n) { return n.fixed; });
}

}  // namespace

void PoseGraphOptions::describe(OptionTable& t) {
  t.add("iterations", iterations, {0, 1000}, "", "most steps");
  t.add("relative_decrease", relative_decrease, {0.0, 0.1}, "",
        "a step that lowers the cost by a smaller share is the last");
  t.add("huber_width", huber_width, {0.0, 1e6}, "",
        "where an edge's weighted residual begins to count linearly; 0 for never");
}

Vector6d pose_graph_residual(const SE3& T_world_from, const SE3& T_world_to, const SE3& T_from_to) {
  return (T_from_to.inverse() * (T_world_from.inverse() * T_world_to)).log();
}

/// With E = T_from_to^-1 T_world_from^-1 T_world_to, a step d of `to` gives E exp(d), and a step of
/// `from` gives T_from_to^-1 exp(-d) ... = exp(-Ad(T_from_to^-1) d) E.
PoseGraphJacobians pose_graph_jacobians(const SE3& T_world_from, const SE3& T_world_to,
                                        const SE3& T_from_to) {
  const Vector6d e = pose_graph_residual(T_world_from, T_world_to, T_from_to);
  return {-se3_left_jacobian_inverse(e) * adjoint(T_from_to.inverse()),
          se3_left_jacobian_inverse(-e)};
}

PoseGraphResult solve_pose_graph(const PoseGraph& graph, const PoseGraphOptions& options,
                                 const std::stop_token& stop) {
  check(graph);
  PoseGraphResult result;
  std::vector<PoseBlock> blocks;
  for (const PoseGraph::Node& node : graph.nodes) {
    result.T_world_node.push_back(node.T_world_node);
    blocks.emplace_back(node.T_world_node);
  }
  result.initial_cost = cost_of(graph, result.T_world_node, options.huber_width);

  TwistManifold<TwistSide::right> manifold;
  ceres::HuberLoss huber(options.huber_width);
  ceres::Problem problem(problem_options());
  for (const PoseGraph::Edge& e : graph.edges) {
    problem.AddResidualBlock(new EdgeCost(e), options.huber_width > 0.0 ? &huber : nullptr,
                             blocks[e.from].values, blocks[e.to].values);
  }
  const bool hold_first = none_fixed(graph);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!problem.HasParameterBlock(blocks[i].values)) continue;
    problem.SetManifold(blocks[i].values, &manifold);
    if (graph.nodes[i].fixed || (hold_first && i == 0)) {
      problem.SetParameterBlockConstant(blocks[i].values);
    }
  }
  if (!graph.edges.empty() && !stop.stop_requested()) {
    ceres::Solver::Options solver = solver_options(options);
    StopCallback callback(stop);
    solver.callbacks.push_back(&callback);
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    result.iterations = std::max(0, static_cast<int>(summary.iterations.size()) - 1);
    result.converged = summary.termination_type == ceres::CONVERGENCE;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (graph.nodes[i].fixed || !problem.HasParameterBlock(blocks[i].values)) continue;
      result.T_world_node[i] = blocks[i].to_se3();
    }
  }
  result.interrupted = stop.stop_requested();
  result.final_cost = cost_of(graph, result.T_world_node, options.huber_width);
  return result;
}

}  // namespace ydd
