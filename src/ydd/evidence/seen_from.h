// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "ydd/geometry/camera.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// Another camera frame to look at points from, in single precision: this runs for every cell.
class SeenFrom {
 public:
  struct Place {
    float z_m = 0;             ///< along that frame's optical axis
    float x_px = 0, y_px = 0;  ///< of the image as it is taken there
  };
  SeenFrom(const SE3& T_there_here, const Camera& camera)
      : camera_(&camera),
        rotation_(T_there_here.rotation_matrix().cast<float>()),
        shift_m_(T_there_here.translation().cast<float>()),
        focal_px_(static_cast<float>(camera.fx_px), static_cast<float>(camera.fy_px)),
        centre_px_(static_cast<float>(camera.cx_px), static_cast<float>(camera.cy_px)),
        lens_(camera.has_distortion()) {}

  /// False when the point (of the frame here, metres) is not before that camera. It may be out of
  /// its picture.
  bool see(const Eigen::Vector3f& p_here, Place& place) const {
    constexpr float kNearest_m = 0.05F;
    const Eigen::Vector3f p = rotation_ * p_here + shift_m_;
    if (p.z() <= kNearest_m) return false;
    const float per_z = 1.0F / p.z();
    place = {p.z(), focal_px_.x() * (p.x() * per_z) + centre_px_.x(),
             focal_px_.y() * (p.y() * per_z) + centre_px_.y()};
    if (!lens_) return true;
    const Eigen::Vector2d px = camera_->distort({place.x_px, place.y_px});
    place.x_px = static_cast<float>(px.x());
    place.y_px = static_cast<float>(px.y());
    return true;
  }

 private:
  const Camera* camera_;
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f shift_m_;
  Eigen::Vector2f focal_px_, centre_px_;
  bool lens_;
};

/// The point that a cell's ray (direction at depth 1) meets at this depth.
inline Eigen::Vector3f point_on(const Eigen::Vector2f& ray, float z_m) {
  return {ray.x() * z_m, ray.y() * z_m, z_m};
}

}  // namespace ydd
