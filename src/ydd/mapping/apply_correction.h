// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "ydd/map/correction.h"
#include "ydd/matching/projection_search.h"

namespace ydd {

/// Moves keyframes and points as the correction says; keyframes that it does not know yet go along
/// with their parent, points with the first keyframe that saw them. What is seen by no keyframe
/// that moves is not touched.
void apply_correction(Atlas& atlas, const Correction& correction);

/// Moves a copy of the snapshot that the correction was computed on, in any thread: applying it
/// then costs as much as has changed meanwhile, however large the map. What neither changed is
/// placed bit by bit as without it, if the keyframe that saw it first has not changed either.
void prepare_correction(std::shared_ptr<const Atlas> before, Correction& correction);

/// Joins the two sides of a junction: one map, one spanning tree, duplicate points fused.
void merge_at(Atlas& atlas, const Correction::Junction& junction, double radius_px,
              int min_covisible_weight, const MatchLimits& limits);

}  // namespace ydd
