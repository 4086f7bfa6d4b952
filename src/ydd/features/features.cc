// SPDX-License-Identifier: Apache-2.0
#include "ydd/features/features.h"

#include <cmath>

namespace ydd {

PyramidScales PyramidScales::make(int levels, double step) {
  PyramidScales scales;
  double factor = 1.0;
  for (int i = 0; i < levels; ++i, factor *= step) {
    scales.factor.push_back(factor);
    scales.inv_sigma2.push_back(1.0 / (factor * factor));
  }
  scales.log_step = std::log(step);
  return scales;
}

Features with_geometry(OrbFeatures orb, const Camera& camera, const DepthImage& depth_m) {
  Features f;
  f.keypoints = std::move(orb.keypoints);
  f.descriptors = std::move(orb.descriptors);
  const std::size_t n = f.keypoints.size();
  f.undistorted_px.reserve(n);
  f.depth_m.reserve(n);
  f.right_px.reserve(n);
  for (const Keypoint& k : f.keypoints) {
    const Eigen::Vector2d px = camera.undistort({k.x_px, k.y_px});
    const int x = static_cast<int>(std::lround(k.x_px));
    const int y = static_cast<int>(std::lround(k.y_px));
    const float depth = depth_m.contains(x, y) ? depth_m(x, y) : 0.0F;
    f.undistorted_px.push_back(px.cast<float>());
    f.depth_m.push_back(depth > 0.0F ? depth : 0.0F);
    f.right_px.push_back(depth > 0.0F ? static_cast<float>(px.x() - camera.bf() / depth) : -1.0F);
  }
  return f;
}

Features select(const Features& features, const std::vector<int>& indices) {
  Features out;
  const auto gather = [&](const auto& from, auto& to) {
    to.reserve(indices.size());
    for (const int i : indices) to.push_back(from[static_cast<std::size_t>(i)]);
  };
  gather(features.keypoints, out.keypoints);
  gather(features.descriptors, out.descriptors);
  gather(features.undistorted_px, out.undistorted_px);
  gather(features.depth_m, out.depth_m);
  gather(features.right_px, out.right_px);
  return out;
}

}  // namespace ydd
