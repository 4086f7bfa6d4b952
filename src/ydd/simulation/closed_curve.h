// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace ydd::sim {

/// A closed uniform cubic B-spline in the plane, walked at constant speed. Passes near its
/// waypoints; twice continuously differentiable.
class ClosedCurve {
 public:
  /// @throws std::logic_error with fewer than three waypoints.
  explicit ClosedCurve(std::vector<Eigen::Vector2d> waypoints);

  double length_m() const { return arc_.back(); }
  /// Position after `distance_m` along the curve, any number of rounds.
  Eigen::Vector2d at(double distance_m) const;

 private:
  Eigen::Vector2d evaluate(double parameter) const;  ///< parameter in waypoints

  std::vector<Eigen::Vector2d> waypoints_;
  std::vector<double> arc_;  ///< distance at equal steps of the parameter
};

}  // namespace ydd::sim
