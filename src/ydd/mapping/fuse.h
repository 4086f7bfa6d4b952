// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ydd/matching/projection_search.h"

namespace ydd {

/// Projects `points` into `keyframe` and, where a keypoint looks like one of them, links it, or
/// merges the two points if the keypoint already has another (the one with more observations
/// stays). Gives how many were linked or merged.
int fuse_points(Atlas& atlas, KeyFrameId keyframe, std::span<const MapPointId> points,
                double radius_px, const MatchLimits& limits);

/// Fuses the points of `keyframe` with those of its neighbours, both ways, and refreshes what
/// changed. Gives how many were linked or merged.
int fuse_with_neighbours(Atlas& atlas, KeyFrameId keyframe, int neighbours, double radius_px,
                         int min_covisible_weight, const MatchLimits& limits);

}  // namespace ydd
