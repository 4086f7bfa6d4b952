// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/map/atlas.h"

namespace ydd::app {

/// One map of an atlas, counted.
struct MapInfo {
  MapId map;
  std::size_t keyframes = 0;
  std::size_t pictures = 0;  ///< keyframes that keep one
  std::size_t points = 0;
  std::size_t loops = 0;
  Timestamp first, last;          ///< of its keyframes
  double path_m = 0;              ///< along its keyframes in the order of creation
  Eigen::Vector3d low_m, high_m;  ///< box around the keyframes' cameras
};

/// The maps that have keyframes, largest first, ties to the older.
std::vector<MapInfo> describe_maps(const Atlas& atlas);

}  // namespace ydd::app
