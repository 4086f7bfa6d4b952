// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include <embree3/rtcore.h>

#include "ydd/simulation/scene.h"

/// A thin owner around Embree. Private to the room: only .cc files and tests of it include this.
namespace ydd::sim {

using Device = std::shared_ptr<RTCDeviceTy>;
using RayScene = std::shared_ptr<RTCSceneTy>;

/// @throws std::runtime_error if Embree does not start.
Device make_device();

/// One geometry per part, in the order given; committed.
RayScene make_ray_scene(const Device& device, const std::vector<Part>& parts);

/// Instances of `groups`, the i-th at T_world_group[i], instance id i; committed.
RayScene make_instance_scene(const Device& device, const std::vector<RayScene>& groups,
                             const std::vector<SE3>& T_world_group);

}  // namespace ydd::sim
