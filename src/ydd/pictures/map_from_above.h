// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "ydd/system/slam_system.h"

namespace ydd {

/// One map of an atlas, seen from above: metres, x to the right and y ahead of its first camera.
///
/// A map's world is its first camera's, so that "above" is as good as that camera was held level.
struct MapFromAbove {
  std::vector<Eigen::Vector2d> points;
  std::vector<Eigen::Vector2d> keyframes;
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> loops;  ///< keyframes that closed one
  std::vector<Eigen::Vector2d> path;                               ///< where `path` was
  std::vector<Timestamp> path_stamps;
  Eigen::Vector2d ahead{0, 1};  ///< where the last pose of the path looks; not of unit length
};

/// The map that `path` ended in; of its points about `most_points` at most, evenly chosen. Empty
/// without a path.
MapFromAbove map_from_above(const Atlas& atlas, std::span<const TrajectoryEntry> path,
                            std::size_t most_points);

}  // namespace ydd
