// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "ydd/map/atlas.h"

namespace ydd {

/// A change of the map, computed on a snapshot, as data. The owner of the map applies it; whatever
/// is newer than the snapshot is carried along with its parent (docs/adr/0001).
struct Correction {
  /// Two keyframes of the same place, whose points become one.
  struct Junction {
    KeyFrameId current;  ///< keyframe whose surroundings are to be fused ...
    KeyFrameId matched;  ///< ... with the surroundings of this one
  };
  std::uint64_t revision = 0;  ///< of the snapshot that it was computed on
  /// Serial from which on keyframes are newer than the snapshot: they go along with their parent.
  /// Older ones that are not named stay where they are.
  std::int64_t newcomers_from = 0;
  std::map<KeyFrameId, SE3> T_world_keyframe;     ///< new poses
  std::map<MapPointId, Eigen::Vector3d> p_world;  ///< new positions; others follow a keyframe
  std::optional<Junction> junction;               ///< of a loop or merge

  /// The snapshot that it was computed on, and the same map moved: in a large map most of the work,
  /// done where nobody waits for it (prepare_correction).
  struct Prepared {
    std::shared_ptr<const Atlas> before, after;
  };
  std::optional<Prepared> prepared;
};

}  // namespace ydd
