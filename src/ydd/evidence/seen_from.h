// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "ydd/geometry/camera.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// Points of a camera frame, metres: parallel arrays, so that loops over them need no branch.
struct PointList {
  std::vector<float> x_m, y_m, z_m;

  std::size_t size() const { return z_m.size(); }
  void reserve(std::size_t n) {
    for (std::vector<float>* v : {&x_m, &y_m, &z_m}) v->reserve(n);
  }
  void push_back(const Eigen::Vector3f& p) {
    x_m.push_back(p.x());
    y_m.push_back(p.y());
    z_m.push_back(p.z());
  }
};

/// Another camera frame to look at points from, in single precision: this runs for every cell.
class SeenFrom {
 public:
  /// Where a point is in another frame.
  struct Place {
    float z_m = 0;             ///< along that frame's optical axis
    float x_px = 0, y_px = 0;  ///< of the image as it is taken there
  };
  /// Places of many points; parallel arrays.
  struct Places {
    std::vector<float> z_m;  ///< 0: not before that camera
    std::vector<float> x_px, y_px;
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
    const Eigen::Vector3f p = rotation_ * p_here + shift_m_;
    if (p.z() <= kNearest_m) return false;
    const float per_z = 1.0F / p.z();
    place = {p.z(), focal_px_.x() * (p.x() * per_z) + centre_px_.x(),
             focal_px_.y() * (p.y() * per_z) + centre_px_.y()};
    if (lens_) through_lens(place.x_px, place.y_px);
    return true;
  }

  /// The same of all points (of the frame here) at once.
  void see_all(const PointList& points, Places& out) const {
    const std::size_t n = points.size();
    for (std::vector<float>* v : {&out.z_m, &out.x_px, &out.y_px}) v->resize(n);
    const Eigen::Matrix3f R = rotation_;
    const Eigen::Vector3f t = shift_m_;
    const Eigen::Vector2f f = focal_px_, c = centre_px_;
    const float* __restrict x = points.x_m.data();
    const float* __restrict y = points.y_m.data();
    const float* __restrict z = points.z_m.data();
    float* __restrict x_px = out.x_px.data();
    float* __restrict y_px = out.y_px.data();
    float* __restrict z_m = out.z_m.data();
    for (std::size_t i = 0; i < n; ++i) {
      const float there_m = R(2, 0) * x[i] + R(2, 1) * y[i] + R(2, 2) * z[i] + t.z();
      const float per_z = 1.0F / std::max(there_m, kNearest_m);
      x_px[i] =
          f.x() * ((R(0, 0) * x[i] + R(0, 1) * y[i] + R(0, 2) * z[i] + t.x()) * per_z) + c.x();
      y_px[i] =
          f.y() * ((R(1, 0) * x[i] + R(1, 1) * y[i] + R(1, 2) * z[i] + t.y()) * per_z) + c.y();
      z_m[i] = there_m > kNearest_m ? there_m : 0.0F;
    }
    for (std::size_t i = 0; lens_ && i < n; ++i) {
      if (out.z_m[i] > 0) through_lens(out.x_px[i], out.y_px[i]);
    }
  }

 private:
  static constexpr float kNearest_m = 0.05F;

  void through_lens(float& x_px, float& y_px) const {
    const Eigen::Vector2d px = camera_->distort({x_px, y_px});
    x_px = static_cast<float>(px.x());
    y_px = static_cast<float>(px.y());
  }

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

/// The points that all cells show; depth 0 where there is no reading.
inline PointList points_on(std::span<const Eigen::Vector2f> rays, std::span<const float> z_m) {
  PointList out;
  out.x_m.resize(rays.size());
  out.y_m.resize(rays.size());
  out.z_m.assign(z_m.begin(), z_m.end());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    out.x_m[i] = rays[i].x() * z_m[i];
    out.y_m[i] = rays[i].y() * z_m[i];
  }
  return out;
}

}  // namespace ydd
