// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/matching/tracked_frame.h"

namespace ydd {

/// How often points should have been seen and were, since the last candidate.
struct PointViews {
  MapPointId point;
  int visible = 0;
  int found = 0;
  int contradicted = 0;  ///< in a row, lately: something is seen behind it, or it lies on a mover
};

/// A frame that the map should keep: everything the mapper needs, by value.
struct KeyFrameCandidate {
  TrackedFrame frame;
  KeyFrameId reference;    ///< empty: it starts a new map
  SE3 T_reference_camera;  ///< the pose to keep if the reference has moved meanwhile
  std::vector<PointViews> views;
  std::vector<ImuSample> imu = {};  ///< since the last one that mapping took; SlamSystem fills it
};

}  // namespace ydd
