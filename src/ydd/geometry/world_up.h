// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "ydd/geometry/se3.h"

namespace ydd {

/// Which way is up in a world that knows no gravity, from how cameras were held: people and robots
/// tilt a camera up and down and turn it round, but hardly ever roll it, so that the x axes of the
/// poses are horizontal. Where the camera never turned round, the mean of the poses' -y decides.
/// Unit vector in the world frame; (0, -1, 0) without any pose.
Eigen::Vector3d world_up(const std::vector<SE3>& T_world_cameras);

}  // namespace ydd
