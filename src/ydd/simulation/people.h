// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/simulation/scene_builder.h"
#include "ydd/simulation/world_options.h"

namespace ydd::sim {

/// Who and what moves in the first room.
struct Cast {
  int walkers = 0;
  int sitters = 0;            ///< at the desks, typing
  bool pushed_chair = false;  ///< one walker pushes the chair of the first desk about
  bool close = false;         ///< a group right before the camera instead of a round walk
  bool fan_turns = false;
};

/// From the options: people and busy.
Cast choose_cast(const WorldOptions& options);

/// Adds people, what they carry and push, the fan, and who comes or leaves to the scene.
void add_actors(SceneBuilder& builder, const WorldOptions& options, const Cast& cast);

}  // namespace ydd::sim
