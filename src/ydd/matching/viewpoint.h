// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ydd/map/atlas.h"

namespace ydd {

/// Where and how a map point appears in an image.
struct VisiblePoint {
  Eigen::Vector2d px;
  double z_m = 0;          ///< along the optical axis
  double view_cosine = 0;  ///< of the angle to the directions that it was seen from before
  int octave = 0;          ///< on which the extractor should find it
};

/// The octave on which a point at `distance_m` should appear.
int predicted_octave(const PyramidScales& scales, double max_distance_m, double distance_m);

/// A camera at a pose, asked about many points.
class Viewpoint {
 public:
  /// Camera and scales must outlive it.
  Viewpoint(const Camera& camera, const PyramidScales& scales, const SE3& T_camera_world)
      : camera_(camera),
        scales_(scales),
        R_camera_world_(T_camera_world.rotation_matrix()),
        t_camera_world_(T_camera_world.translation()),
        centre_world_(T_camera_world.inverse().translation()) {}

  /// Nothing where the point lies behind the camera or outside the image, nearer or farther than
  /// the extractor's pyramid shows it, or is seen more than 60 degrees from its usual direction.
  /// `Point` has p_world, normal, min_distance_m and max_distance_m: a MapPoint or LocalPoint.
  template <class Point>
  std::optional<VisiblePoint> see(const Point& point) const {
    const Eigen::Vector3d p_camera = R_camera_world_ * point.p_world + t_camera_world_;
    if (p_camera.z() <= 0) return std::nullopt;
    const Eigen::Vector2d px = camera_.project(p_camera);
    if (!camera_.contains(px)) return std::nullopt;
    const Eigen::Vector3d ray = point.p_world - centre_world_;
    const double distance_m = ray.norm();
    if (distance_m < 0.8 * point.min_distance_m || distance_m > 1.2 * point.max_distance_m) {
      return std::nullopt;
    }
    const double view_cosine = ray.dot(point.normal) / distance_m;
    if (view_cosine < kMinViewCosine) return std::nullopt;
    return VisiblePoint{px, p_camera.z(), view_cosine,
                        predicted_octave(scales_, point.max_distance_m, distance_m)};
  }

 private:
  static constexpr double kMinViewCosine = 0.5;

  const Camera& camera_;
  const PyramidScales& scales_;
  Eigen::Matrix3d R_camera_world_;
  Eigen::Vector3d t_camera_world_;
  Eigen::Vector3d centre_world_;
};

}  // namespace ydd
