// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ydd/matching/tracked_frame.h"

namespace ydd {

/// How many samples, and what agrees with one.
struct PnpRansacOptions {
  int iterations = 200;       ///< samples drawn at most
  double threshold_px = 4.0;  ///< inlier distance
  unsigned seed = 0;
};

/// The pose (T_camera_world) that most matches agree with, from samples of three and a fourth that
/// chooses among the solutions; nothing when no consensus of four is found. Pixels are undistorted.
/// Draws fewer samples when many agree (with 99 % confidence one sample is free of outliers).
///
/// Every choice follows from the seed. Fischler and Bolles, "Random sample consensus", CACM 1981;
/// three points: Ke and Roumeliotis, "An efficient algebraic solution to the
/// perspective-three-point problem", CVPR 2017 (OpenCV's AP3P).
std::optional<SE3> pnp_ransac(const Camera& camera, const Features& features,
                              const std::vector<PointMatch>& matches,
                              const PnpRansacOptions& options);

}  // namespace ydd
