// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "ydd/geometry/se3.h"

namespace ydd {

/// The floor of a map, in the map's world frame.
struct FloorPlane {
  Eigen::Vector3d up{0, -1, 0};  ///< unit normal
  double height_m = 0;           ///< of its points: up . p
  double share = 0;              ///< of the points that lie on it
  bool found = false;  ///< else the lowest points are taken for the floor, `up` as it was expected
};

/// The lowest large plane whose normal is within 35 degrees of `expected_up` (world_up, which a
/// camera that always looked down a little has wrong by that), by random samples of three points
/// (RANSAC: Fischler, Bolles, 1981) and least squares over what agrees. A plane with more than a
/// few points below it is a table. Deterministic for a seed.
FloorPlane find_floor(std::span<const Eigen::Vector3f> points_world,
                      const Eigen::Vector3d& expected_up, std::uint32_t seed = 1);

/// A level frame on the floor: z up, 0 on the floor; x the horizontal part of the world's z axis
/// (ahead of the map's first camera), y to its left; the origin below the world's.
SE3 level_frame(const FloorPlane& floor);

}  // namespace ydd
