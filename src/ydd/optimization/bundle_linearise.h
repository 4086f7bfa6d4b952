// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ydd/optimization/bundle_adjustment.h"
#include "ydd/optimization/reprojection.h"

/// First stage of the bundle adjustment: the problem in the order in which it is worked through,
/// and its normal equations at a state.
namespace ydd::bundle {

using Matrix63d = Eigen::Matrix<double, 6, 3>;

/// The observations sorted by point, then pose, so that all that concerns a point lies together.
struct Layout {
  /// An observation of a point, by where it goes in the equations.
  struct Entry {
    int pose = 0;
    int column = -1;  ///< of the pose among the free ones; -1: fixed
    int source = 0;   ///< index into BundleProblem::observations
    bool stereo = false;
    bool usable = false;  ///< finite, with positive information
    Eigen::Vector3d uvr_px;
    double inv_sigma2 = 1.0;
  };
  std::vector<Entry> entries;
  std::vector<int> first;           ///< of a point's entries; one more than there are points
  std::vector<int> pose_of_column;  ///< free poses, ascending

  /// Null without inertial links; what follows is empty then. Part of the problem.
  const InertialProblem* inertial = nullptr;
  std::vector<int> column_of_pose;         ///< -1: fixed
  std::vector<int> speed_at;               ///< of a pose, in the border; -1: not linked
  std::vector<Matrix9d> link_information;  ///< per link
  int border = 0;                          ///< unknowns besides poses and points

  int points() const { return static_cast<int>(first.size()) - 1; }
  int columns() const { return static_cast<int>(pose_of_column.size()); }
};

/// Holds the first pose when none is fixed. @throws std::logic_error on an index out of range.
Layout make_layout(const BundleProblem& problem);

/// What is being improved.
struct State {
  std::vector<SE3> T_camera_world;
  std::vector<Eigen::Vector3d> points;  ///< world, metres
  InertialUnknowns inertial = {};
};

/// Where the improvement starts.
State state_of(const BundleProblem& problem);

/// How a squared residual becomes cost.
struct Loss {
  double chi2_mono = 5.991;
  double chi2_stereo = 7.815;
  bool huber = true;  ///< Huber's kernel, widths the square roots of the gates; else squares
};

/// What unknowns that belong to no point and to several poses add to the normal equations.
struct Border {
  /// The block of two poses, by their columns, row > col.
  struct Pair {
    int row = 0, col = 0;
    Matrix6d hessian;
  };
  Eigen::MatrixXd hessian;   ///< of the further unknowns; empty: there are none
  Eigen::VectorXd gradient;  ///< the same
  Eigen::MatrixXd coupling;  ///< of all poses' columns with them
  std::vector<Pair> pairs;
};

/// Normal equations: block diagonals of poses (U) and points (V), their coupling W per entry, and
/// the gradients. A left perturbation (translation, rotation) for poses, metres for points.
struct NormalEquations {
  double cost = 0.0;
  std::vector<Matrix6d> pose_hessian;  ///< per column
  std::vector<Vector6d> pose_gradient;
  std::vector<Eigen::Matrix3d> point_hessian;
  std::vector<Eigen::Vector3d> point_gradient;
  std::vector<Matrix63d> coupling;  ///< per entry; only free poses' active ones have a meaning
  Border border;
};

/// At `state` over entries with `active` set; the buffers of `reuse` are recycled.
NormalEquations linearise(const Intrinsics& k, const Layout& layout,
                          const std::vector<std::uint8_t>& active, const State& state,
                          const Loss& loss, NormalEquations reuse = {});

/// 0.5 * sum of losses over active entries.
double cost_of(const Intrinsics& k, const Layout& layout, const std::vector<std::uint8_t>& active,
               const State& state, const Loss& loss);

/// Per entry: usable, in front of the camera, and chi-square within `gates` times the gate.
std::vector<std::uint8_t> judge(const Intrinsics& k, const Layout& layout, const State& state,
                                const Loss& loss, double gates = 1.0);

}  // namespace ydd::bundle
