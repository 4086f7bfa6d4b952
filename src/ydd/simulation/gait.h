// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/simulation/person.h"

/// How people get about.
namespace ydd::sim {

/// T_world_person of somebody on the floor at `place_m`, forward towards the heading from +x.
SE3 on_floor(const Eigen::Vector2d& place_m, double heading_rad);

/// Limbs after `distance_m` on foot: legs swing with the distance, so that the standing foot stays
/// where it is, arms against them. `liveliness` in [0, 1]: 0 stands still, 1 walks briskly.
PersonPose stride(const PersonShape& shape, double distance_m, double liveliness);

}  // namespace ydd::sim
