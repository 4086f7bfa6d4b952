// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "ydd/geometry/se3.h"
#include "ydd/simulation/world_options.h"

namespace ydd {

/// T_world_camera at a time in seconds since the first frame: pure and smooth, so that frames can
/// be rendered in any order. World: z up, floor at 0. Tests may make their own (a kidnapped camera
/// is a path that jumps).
using CameraPath = std::function<SE3(double time_s)>;

/// A path and how long it takes.
struct TimedPath {
  CameraPath T_world_camera;
  double round_s = 10.0;  ///< after this the path has shown what it is for
};

/// Camera at `eye` that looks at `target`, upright but for `roll_rad` about its axis.
SE3 look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, double roll_rad = 0);

/// The path named by `options.path`, in the first room (room_loop: through all of them): the
/// motions of the TUM RGB-D benchmark, held by hand.
TimedPath make_camera_path(const WorldOptions& options);

/// Where the camera is held on the paths that stay in front of the desks.
inline const Eigen::Vector3d kCameraPlace_m{2.9, 1.5, 1.4};

}  // namespace ydd
