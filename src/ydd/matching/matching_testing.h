// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "ydd/map/world_testing.h"
#include "ydd/matching/tracked_frame.h"

/// Frames of a testing world, for the tests of this room and of those that match.
namespace ydd::testing_world {

inline constexpr std::int64_t kFrameInterval_ns = 33'333'333;

/// A look with half a pixel of noise, depth off by 2 mm at one metre, and so many wrong bits in
/// each descriptor.
inline ViewOptions noisy_view(unsigned seed, int flipped_bits) {
  ViewOptions options;
  options.noise_px = 0.5;
  options.depth_noise = 0.002;
  options.flipped_bits = flipped_bits;
  options.seed = seed;
  return options;
}

/// A frame as the tracker gets it: without pose and points.
inline TrackedFrame frame_of(const View& view, std::int64_t index = 0) {
  TrackedFrame frame;
  frame.index = index;
  frame.stamp = {1'000'000'000 + index * kFrameInterval_ns};
  frame.shared_features = view.shared_features;
  frame.grid = view.grid;
  frame.points.assign(view.features().size(), MapPointId{});
  return frame;
}

/// The same with its true pose and, from `share` of the map's points, those it shows.
inline TrackedFrame known_frame_of(const View& view, const BuiltMap& built, double share = 1.0) {
  TrackedFrame frame = frame_of(view);
  frame.T_camera_world = view.T_world_camera.inverse();
  for (std::size_t k = 0; k < view.shown.size(); ++k) {
    if (static_cast<double>(k) >= share * static_cast<double>(view.shown.size())) break;
    frame.points[k] = built.points[static_cast<std::size_t>(view.shown[k])];
  }
  return frame;
}

/// Distance between two camera positions, metres.
inline double position_error_m(const SE3& a, const SE3& b) {
  return (a.translation() - b.translation()).norm();
}

/// Angle between two orientations, radians.
inline double rotation_error_rad(const SE3& a, const SE3& b) {
  return (a.inverse() * b).angle_rad();
}

}  // namespace ydd::testing_world
