// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/simulation/scene_builder.h"

/// People who are there for a part of the sequence only, right before the camera of the paths that
/// stay in front of the desks.
namespace ydd::sim {

inline constexpr double kLeaverStands_s = 3.0;  ///< until then without a move
inline constexpr double kComerArrives_s = 2.0;  ///< from then on without a move

/// Stands still and faces the camera, then walks past it and does not come back.
void add_leaver(SceneBuilder& builder, int number);
/// Walks in from beside the camera, then stands still and faces it to the end.
void add_comer(SceneBuilder& builder, int number);

}  // namespace ydd::sim
