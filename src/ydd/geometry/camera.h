// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "ydd/base/options.h"
#include "ydd/base/result.h"

namespace ydd {

/// A calibrated RGB-D camera: pinhole, radial-tangential distortion of the colour image, and how
/// its registered depth image is to be read. Pixel centres are at integer coordinates.
///
/// Camera frame: x right, y down, z forward. Distortion as in OpenCV (k1 k2 p1 p2 k3).
struct Camera {
  std::string name = "camera";
  int width_px = 640;
  int height_px = 480;
  double fx_px = 525.0;
  double fy_px = 525.0;
  double cx_px = 319.5;
  double cy_px = 239.5;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  double depth_scale = 5000.0;  ///< depth image value of one metre
  double min_depth_m = 0.1;     ///< nearer readings are invalid
  double max_depth_m = 10.0;    ///< farther readings are invalid
  double fps = 30.0;
  /// Baseline of the virtual stereo pair in which a depth reading becomes a right-image
  /// coordinate: `u_right = u - fx * baseline_m / depth`. It sets how much a depth reading weighs
  /// against pixels: its error is taken as one pixel of that coordinate. 0.15 m, twice the distance
  /// between projector and camera of a Kinect, measured best over real and simulated sequences.
  double baseline_m = 0.15;

  void describe(OptionTable& table);

  /// fx * baseline, pixel metres.
  double bf() const { return fx_px * baseline_m; }
  /// Whether its lens bends lines: any coefficient is not 0.
  bool has_distortion() const { return k1 != 0 || k2 != 0 || p1 != 0 || p2 != 0 || k3 != 0; }

  /// Ideal (undistorted) pixel of a point in the camera frame; z must be > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& p_camera) const {
    return {fx_px * p_camera.x() / p_camera.z() + cx_px,
            fy_px * p_camera.y() / p_camera.z() + cy_px};
  }
  /// Point at `depth_m` along the optical axis behind an undistorted pixel.
  Eigen::Vector3d unproject(const Eigen::Vector2d& undistorted_px, double depth_m) const {
    return {(undistorted_px.x() - cx_px) / fx_px * depth_m,
            (undistorted_px.y() - cy_px) / fy_px * depth_m, depth_m};
  }
  /// Where an ideal pixel is seen in the real image.
  Eigen::Vector2d distort(const Eigen::Vector2d& undistorted_px) const;
  /// Inverse of `distort`, by fixed-point iteration with Newton steps; accurate to 1e-6 px inside
  /// the image for the lenses of RGB-D cameras.
  Eigen::Vector2d undistort(const Eigen::Vector2d& image_px) const;

  /// Whether a pixel position lies on the image.
  bool contains(const Eigen::Vector2d& px) const {
    return px.x() >= 0 && px.y() >= 0 && px.x() < width_px && px.y() < height_px;
  }
  /// Whether a depth in metres lies within the camera's limits; 0, no reading, does not.
  bool is_valid_depth(double depth_m) const {
    return depth_m >= min_depth_m && depth_m <= max_depth_m;
  }
};

/// Whether these can be the values of a real camera: each in its range, the principal point in the
/// picture, an opening of 3 to 150 degrees, pixels at most twice as high as wide or as wide as
/// high, min_depth below max_depth. One line says what is not. For cameras from files, maps and
/// options alike.
Result<void> check_camera(const Camera& camera);

}  // namespace ydd
