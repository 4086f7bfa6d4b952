// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/image/image.h"
#include "ydd/simulation/renderer.h"

namespace ydd::sim {

/// Depth as the ideal sensor of this camera gives it: exact, 0 outside the camera's limits.
DepthImage exact_depth(const Rendering& rendering, const Camera& camera);

/// Standard deviation of a structured-light reading along the optical axis: 1.2 mm + 1.9 mm *
/// (z - 0.4 m)^2 (Nguyen, Izadi, Lovell 2012, eq. 3).
double kinect_noise_m(double depth_m);

/// Depth as a structured-light camera (Kinect) gives it, from exact depth:
/// - no reading where the projector, 7.5 cm to the side, does not shine, and at grazing angles;
/// - ragged silhouettes: a reading near an edge may come from a pixel next to it, or not at all;
/// - axial noise of `kinect_noise_m`, then disparity in steps of 1/8 px (of a 640 px wide sensor);
/// - readings outside the camera's limits are 0.
/// The same `seed` gives the same noise.
DepthImage kinect_depth(const Rendering& rendering, const Camera& camera, std::uint64_t seed);

/// Where the projector sits, in the camera frame.
Vector3 kinect_projector_camera_m();

}  // namespace ydd::sim
