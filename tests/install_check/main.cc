// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>

#include "ydd/dynamics/filtered_features.h"
#include "ydd/geometry/camera.h"
#include "ydd/geometry/se3.h"

/// Uses a few installed libraries from outside the project: headers, archives and their
/// dependencies must be found by find_package(ydd-slam) alone.
int main() {
  ydd::Vector6d twist;
  twist << 1.0, 2.0, 3.0, 0.1, 0.2, 0.3;
  const ydd::SE3 T_a_b = ydd::SE3::exp(twist);
  const double residual = ((T_a_b * T_a_b.inverse()).log()).norm();

  ydd::Camera camera;
  camera.k1 = 0.2;
  const Eigen::Vector2d seen_px(100.0, 120.0);
  const double lens_px = (camera.distort(camera.undistort(seen_px)) - seen_px).norm();

  std::printf("installed ydd-slam: inverse to %.1e, lens to %.1e px, %zu points\n", residual,
              lens_px, ydd::FilteredFeatures().extracted());
  return residual < 1e-9 && lens_px < 1e-6 ? 0 : 1;
}
