// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ydd/map/atlas.h"

namespace ydd {

/// How a large map is grown from small ones.
struct BuildingOptions {
  std::size_t keyframes = 1000;  ///< at least so many: the last room is complete
  std::uint64_t seed = 1;
  int rooms_per_row = 8;
  int rooms_per_floor = 32;
  int revisit_every = 4;  ///< every so many rooms of the first session are seen again in a second
};

/// One look into a room, and the one that a later session took from the same place.
struct Revisit {
  KeyFrameId before;
  KeyFrameId again;
};

/// A map of any size whose every keyframe looks like a real one.
struct Building {
  Atlas atlas;                    ///< map 0: the first session; map 1: the second, if there is one
  std::vector<Revisit> revisits;  ///< pairs of the two sessions
  /// Keyframes of the first session in rooms that the second leaves out, in the order of creation.
  std::vector<KeyFrameId> seen_once;
};

/// Grows a building out of rooms that were really mapped: each room of the building is a copy of
/// one of `rooms` (kept keyframes and their points; one map each), moved to its place on its floor.
///
/// In each copy every point and every keypoint without one looks different: 64 of its 256 tests
/// are turned round, the same ones wherever that point is seen, so that matching works within a
/// room, copies of it are no rivals, and words are spread as in real pictures. The second session
/// sees some of the rooms again, each keypoint with 8 further tests turned round (another day,
/// another light), as a map of its own. Rooms of one session hang together by the spanning tree
/// alone.
///
/// Deterministic. Cheap: 1 ms a keyframe. @throws std::logic_error when `rooms` is empty or
/// without keyframes.
Building grow_building(const std::vector<std::shared_ptr<const Atlas>>& rooms,
                       const BuildingOptions& options);

}  // namespace ydd
