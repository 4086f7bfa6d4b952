// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/simulation/scene_builder.h"
#include "ydd/simulation/world_options.h"

namespace ydd::sim {

/// Rooms stand side by side along x; room k has its lower left corner at (k * kRoomPitch_m, 0).
/// The desks stand at the wall y = kRoomDepth_m.
inline constexpr double kRoomWidth_m = 6.0;   ///< x
inline constexpr double kRoomDepth_m = 5.0;   ///< y
inline constexpr double kRoomHeight_m = 2.7;  ///< z
inline constexpr double kRoomPitch_m = 6.15;  ///< room and the wall to its neighbour
inline constexpr double kDoorMiddle_m = 2.5;  ///< y of the passages between rooms
inline constexpr double kDoorWidth_m = 1.1;

/// Where the fan stands in the first room (its foot).
inline constexpr double kFanPlace_m[3] = {4.1, 4.72, 0.9};
/// Where the chairs stand in front of the desks (the sitter's side is -y).
inline constexpr double kChairPlaces_m[2][2] = {{1.05, 3.95}, {2.75, 3.95}};

/// Builds walls, furniture and clutter of all rooms into `builder`. Chairs are left out where
/// `fixed_chair[i]` of the first room is false: an actor brings that one.
void build_rooms(SceneBuilder& builder, const WorldOptions& options,
                 const std::array<bool, 2>& fixed_chair);

}  // namespace ydd::sim
