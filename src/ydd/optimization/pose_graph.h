// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <vector>

#include "ydd/base/options.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// Poses held together by measured relative motions: what closing a loop corrects.
struct PoseGraph {
  /// A pose of the graph.
  struct Node {
    SE3 T_world_node;
    bool fixed = false;
  };
  /// A measured motion between two nodes.
  struct Edge {
    int from = 0;                                 ///< index into nodes
    int to = 0;                                   ///< index into nodes, another one
    SE3 T_from_to;                                ///< measured
    Matrix6d information = Matrix6d::Identity();  ///< of the residual: 1/m^2, 1/rad^2
  };
  std::vector<Node> nodes;
  std::vector<Edge> edges;
};

/// How long is solved.
struct PoseGraphOptions {
  int iterations = 50;
  double relative_decrease = 1e-8;  ///< a step that lowers the cost by less is the last
  double huber_width = 0.0;         ///< of an edge's weighted residual norm; 0: plain squares
  void describe(OptionTable& table);
};

/// The solution.
struct PoseGraphResult {
  std::vector<SE3> T_world_node;  ///< one per node
  double initial_cost = 0.0;      ///< 0.5 * sum of (robustified) squared weighted residuals
  double final_cost = 0.0;
  int iterations = 0;
  bool converged = false;    ///< false: iterations used up, interrupted, or the solver failed
  bool interrupted = false;  ///< `stop` was requested; the best state so far is given
};

/// What an edge is from agreeing with its nodes: log(T_from_to^-1 * T_world_from^-1 * T_world_to),
/// a twist (translation in m, rotation in rad) in the measured frame of `to`.
Vector6d pose_graph_residual(const SE3& T_world_from, const SE3& T_world_to, const SE3& T_from_to);

/// Derivatives of `pose_graph_residual` by right perturbations T_world_node * exp(twist).
struct PoseGraphJacobians {
  Matrix6d by_from;
  Matrix6d by_to;
};
PoseGraphJacobians pose_graph_jacobians(const SE3& T_world_from, const SE3& T_world_to,
                                        const SE3& T_from_to);

/// Minimises the weighted residuals over all nodes that are not fixed, by Ceres (Levenberg-
/// Marquardt, sparse Cholesky, analytic derivatives, one thread). Deterministic. At least one node
/// should be fixed in each connected part; if none is fixed at all, the first is held. Nodes
/// without edges stay.
/// @throws std::logic_error if an edge names a node that is not there or joins a node to itself, or
/// its information is not finite and positive semidefinite.
PoseGraphResult solve_pose_graph(const PoseGraph& graph, const PoseGraphOptions& options,
                                 const std::stop_token& stop = {});

}  // namespace ydd
