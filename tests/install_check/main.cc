// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include "ydd/dynamics/filtered_features.h"
#include "ydd/geometry/camera.h"
#include "ydd/geometry/se3.h"
#include "ydd/image/decode.h"
#include "ydd/image/rgbd_frame.h"

/// As docs/reference.md has it: a frame of what a camera's driver gives.
ydd::RgbdFrame frame_of(std::int64_t stamp_ns, std::vector<ydd::Bgr> bgr,
                        std::vector<std::uint16_t> depth_counts, const ydd::Camera& camera) {
  const int width = camera.width_px, height = camera.height_px;
  ydd::RgbdFrame frame;
  frame.stamp = {stamp_ns};
  frame.colour = ydd::ColourImage(width, height, std::move(bgr));
  frame.grey = ydd::to_grey(frame.colour);
  frame.depth_m =
      ydd::to_metres(ydd::RawDepthImage(width, height, std::move(depth_counts)), camera);
  return frame;
}

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

  const std::size_t pixels = std::size_t(camera.width_px) * std::size_t(camera.height_px);
  const ydd::RgbdFrame frame = frame_of(0, std::vector<ydd::Bgr>(pixels, {10, 10, 10}),
                                        std::vector<std::uint16_t>(pixels, 5000), camera);

  std::printf("installed ydd-slam: inverse to %.1e, lens to %.1e px, %zu points\n", residual,
              lens_px, ydd::FilteredFeatures().extracted());
  const bool framed = frame.grey(7, 5) == 10 && frame.depth_m(7, 5) == 1.0F;
  return residual < 1e-9 && lens_px < 1e-6 && framed ? 0 : 1;
}
