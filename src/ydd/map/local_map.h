// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ydd/map/atlas.h"

namespace ydd {

/// What the tracker needs of a point, laid out for a linear walk.
struct LocalPoint {
  Eigen::Vector3d p_world;
  Eigen::Vector3d normal;
  double min_distance_m = 0;
  double max_distance_m = 0;
  Descriptor descriptor{};
  MapPointId id;
};

/// The few thousand points around the camera, from one revision of the atlas.
struct LocalMap {
  std::uint64_t revision = 0;
  KeyFrameId reference;               ///< the keyframe that shares most points with the frame
  std::vector<KeyFrameId> keyframes;  ///< those that share points, then their neighbours
  std::vector<LocalPoint> points;
};

/// The keyframe that sees most of `points`, ties to the newest; empty when none does.
KeyFrameId most_shared_keyframe(const Atlas& atlas, std::span<const MapPointId> points);

/// Gathers the keyframes that see any of `points` and their neighbours (best covisible ones,
/// parent), at most `max_keyframes`, and all their points. When no point is known, the
/// neighbourhood of `fallback`.
LocalMap gather_local_map(const Atlas& atlas, std::span<const MapPointId> points,
                          KeyFrameId fallback, int max_keyframes);

}  // namespace ydd
