// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "ydd/geometry/se3.h"

namespace ydd {

/// The point that two rays meet in, linearly (Hartley and Zisserman, Multiple View Geometry, 2nd
/// ed., section 12.2), in the world frame. `ray_*` are normalised image coordinates (x/z, y/z, 1).
/// Nothing when the rays are parallel.
std::optional<Eigen::Vector3d> triangulate(const SE3& T_camera1_world, const Eigen::Vector3d& ray1,
                                           const SE3& T_camera2_world, const Eigen::Vector3d& ray2);

}  // namespace ydd
