// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#ifdef YDD_EMBREE4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "ydd/simulation/scene.h"

/// A thin owner around Embree 3 or 4. Private to the room: only .cc files and tests of it include
/// this.
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

/// What the first eight rays that are `valid` (-1; 0: not) hit. `coherent`: they look alike, which
/// is quicker and changes nothing.
void intersect(RTCScene scene, const int* valid, RTCRayHit8& rays, bool coherent);
/// Makes `tfar` negative of those that hit anything.
void find_occluded(RTCScene scene, const int* valid, RTCRay8& rays, bool coherent);
void find_occluded(RTCScene scene, RTCRay& ray);

}  // namespace ydd::sim
