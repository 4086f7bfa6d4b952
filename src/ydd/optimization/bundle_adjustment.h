// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "ydd/base/options.h"
#include "ydd/geometry/camera.h"
#include "ydd/geometry/se3.h"
#include "ydd/optimization/inertial_factor.h"

namespace ydd {

/// Poses and points that see each other. Knows no map: the mapper gathers it and applies the
/// result.
struct BundleProblem {
  /// A camera of the problem.
  struct Pose {
    SE3 T_camera_world;
    bool fixed = false;
  };
  /// A point that a camera sees.
  struct Observation {
    int pose = 0;             ///< index into poses
    int point = 0;            ///< index into points
    Eigen::Vector3d uvr_px;   ///< as PoseObservation::uvr_px
    double inv_sigma2 = 1.0;  ///< 1/px^2
  };
  std::vector<Pose> poses;
  std::vector<Eigen::Vector3d> points;  ///< world, metres
  std::vector<Observation> observations;
  std::optional<InertialProblem> inertial;  ///< what an IMU says between the poses
};

/// How long is solved, and what is an outlier.
struct BundleOptions {
  int robust_iterations = 5;  ///< with the Huber kernel, before outliers are set aside
  int final_iterations = 10;  ///< without them
  double chi2_mono = 5.991;
  double chi2_stereo = 7.815;
  double relative_decrease = 1e-6;  ///< a step that lowers the cost by less ends its phase
  void describe(OptionTable& table);
};

/// The solution.
struct BundleResult {
  std::vector<SE3> T_camera_world;           ///< one per pose
  std::vector<Eigen::Vector3d> points;       ///< one per point
  std::vector<std::uint8_t> inlier;          ///< one per observation
  std::optional<InertialUnknowns> inertial;  ///< if the problem has inertial links
  double initial_cost = 0.0;                 ///< 0.5 * sum of robustified squared residuals
  double final_cost = 0.0;                   ///< the same over all observations at the solution
  int iterations = 0;
  bool interrupted = false;  ///< `stop` was requested; the best state so far is given
};

/// Called after each iteration with how many there were in this phase.
using BundleWatch = std::function<void(int iterations)>;

/// Minimises reprojection error over free poses and all points by Levenberg-Marquardt, eliminating
/// the points (Schur complement): first all observations under Huber's kernel (widths: square roots
/// of the gates), then, without kernel, those that pass the gates.
///
/// At least one pose should be fixed; if none is, the first is held. Points and poses that nothing
/// observes stay. Points behind a camera and observations that are not finite or have no positive
/// `inv_sigma2` are outliers; the latter never count in a cost. Inertial links, if there are any,
/// are part of the cost. Deterministic: one thread, fixed
/// order. `stop` is looked at between the phases of an iteration.
/// @throws std::logic_error if an observation names a pose or point that is not there.
BundleResult solve_bundle(const Camera& camera, const BundleProblem& problem,
                          const BundleOptions& options, const std::stop_token& stop = {},
                          const BundleWatch& watch = {});

}  // namespace ydd
