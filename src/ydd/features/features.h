// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "ydd/geometry/camera.h"
#include "ydd/image/image.h"

namespace ydd {

/// 256 binary tests.
using Descriptor = std::array<std::uint64_t, 4>;

/// Number of differing bits, 0 to 256.
inline int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

/// A corner in the image as it was taken (distorted), in pixels of pyramid level 0.
struct Keypoint {
  float x_px = 0;       ///< column
  float y_px = 0;       ///< row
  float angle_rad = 0;  ///< orientation by intensity centroid, [0, 2 pi)
  float response = 0;   ///< corner score; larger is stronger
  int octave = 0;       ///< pyramid level it was found on
};

/// What the extractor gives: parallel arrays.
struct OrbFeatures {
  std::vector<Keypoint> keypoints;      ///< the strongest of each place, evenly spread
  std::vector<Descriptor> descriptors;  ///< one for each keypoint
};

/// Scale of each pyramid level and the variance of a keypoint on it.
struct PyramidScales {
  std::vector<double> factor;      ///< 1, 1.2, 1.44, ...
  std::vector<double> inv_sigma2;  ///< 1 / factor^2: information of a pixel coordinate, 1/px^2
  double log_step = 0;             ///< ln of the step between levels
  /// Of `levels` levels, each smaller than the one below by `step`, which is more than 1.
  static PyramidScales make(int levels, double step);
  /// Number of levels; 0 is the image as it was taken.
  int levels() const { return static_cast<int>(factor.size()); }
};

/// Features with their geometry: parallel arrays, one entry per keypoint.
struct Features {
  std::vector<Keypoint> keypoints;              ///< as they were found in the image
  std::vector<Descriptor> descriptors;          ///< one for each keypoint
  std::vector<Eigen::Vector2f> undistorted_px;  ///< ideal pixel
  std::vector<float> depth_m;                   ///< along the optical axis; 0: no reading
  std::vector<float> right_px;                  ///< virtual right-image x; negative: no reading

  /// Number of keypoints, and so of every array.
  std::size_t size() const { return keypoints.size(); }
  /// Whether keypoint `i` has a depth reading. Unchecked.
  bool has_depth(std::size_t i) const { return depth_m[i] > 0.0F; }
};

/// Adds undistorted coordinates, depth (at the nearest pixel of the registered depth image) and the
/// virtual right-image coordinate to extracted features.
Features with_geometry(OrbFeatures features, const Camera& camera, const DepthImage& depth_m);

/// The entries named by `indices`, in that order.
Features select(const Features& features, const std::vector<int>& indices);

}  // namespace ydd
