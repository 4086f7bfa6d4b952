// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "ydd/optimization/bundle_linearise.h"

namespace ydd::bundle {

/// A step of all unknowns.
struct Step {
  std::vector<Vector6d> poses;          ///< per column: left twist, translation first
  std::vector<Eigen::Vector3d> points;  ///< metres
  Eigen::VectorXd border;               ///< of the further unknowns
  double predicted_decrease = 0.0;      ///< of the cost, by the damped quadratic model
};

/// Solves the damped normal equations by eliminating the points (Schur complement; Triggs et al.,
/// Bundle adjustment - a modern synthesis, 2000, section 6.1). The reduced system of the poses is
/// factorised by TileCholesky, its pattern found once. Further unknowns, if there are any, are
/// found from what eliminating the poses leaves of their own equations.
class SchurSolver {
 public:
  explicit SchurSolver(const Layout& layout);
  ~SchurSolver();
  SchurSolver(const SchurSolver&) = delete;
  SchurSolver& operator=(const SchurSolver&) = delete;

  /// The step for the damping `lambda` times the diagonal (Marquardt). Entries that are not
  /// `active` are left out, as in `linearise`. Nothing when the reduced system cannot be
  /// factorised (not finite, or not positive definite by rounding) or `stop` was requested.
  std::optional<Step> solve(const NormalEquations& equations,
                            const std::vector<std::uint8_t>& active, double lambda,
                            const std::stop_token& stop);

 private:
  struct Reduced;
  const Layout& layout_;
  std::unique_ptr<Reduced> reduced_;
};

}  // namespace ydd::bundle
