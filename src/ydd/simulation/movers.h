// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/simulation/scene_builder.h"
#include "ydd/simulation/world_options.h"

namespace ydd::sim {

/// Adds the mover that the options name, if any: an object of class "thing", which no detector
/// knows, between the camera of the paths in front of the desks and the desks, so close that it
/// holds about a third of the picture.
void add_large_mover(SceneBuilder& builder, const WorldOptions& options);

}  // namespace ydd::sim
