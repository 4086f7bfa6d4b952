// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ydd/base/options.h"
#include "ydd/geometry/camera.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// A known point seen in the image, in undistorted pixels.
struct PoseObservation {
  Eigen::Vector3d p_world;  ///< metres
  Eigen::Vector3d uvr_px;   ///< u, v, virtual right-image u; negative third: no depth reading
  double inv_sigma2 = 1.0;  ///< information of one coordinate, 1/px^2
};

/// How long is solved, and what is an outlier.
struct PoseOnlyOptions {
  int rounds = 4;  ///< after each, observations are judged inlier or outlier anew
  int iterations_per_round = 10;
  double chi2_mono = 5.991;    ///< 95 % of chi-square with 2 degrees of freedom
  double chi2_stereo = 7.815;  ///< 95 % with 3 degrees of freedom
  void describe(OptionTable& table);
};

/// The solution.
struct PoseOnlyResult {
  SE3 T_camera_world;
  std::vector<std::uint8_t> inlier;  ///< one per observation
  int inliers = 0;
};

/// The camera pose that best explains the observations, robustly, by Levenberg-Marquardt with
/// analytic Jacobians: Huber's kernel (widths: square roots of the gates) in the first half of the
/// rounds, plain least squares on the inliers after that. Each round starts from the pose of the
/// one before and judges all observations anew; points behind the camera and observations that are
/// not finite or have no positive `inv_sigma2` are outliers.
///
/// With fewer than three observations, or when fewer than three inliers are left, the initial pose
/// comes back with no inliers. Deterministic. Any thread.
PoseOnlyResult optimize_pose(const Camera& camera, const SE3& T_camera_world,
                             std::span<const PoseObservation> observations,
                             const PoseOnlyOptions& options);

/// Gauss-Newton Hessian at a pose (inliers, no robust weights): its information for a left
/// perturbation exp(twist) * T_camera_world, twist = (translation, rotation).
Matrix6d pose_information(const Camera& camera, const SE3& T_camera_world,
                          std::span<const PoseObservation> observations,
                          std::span<const std::uint8_t> inlier);

}  // namespace ydd
