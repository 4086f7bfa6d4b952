// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/image/image.h"
#include "ydd/system/slam_system.h"

namespace ydd {

/// The map seen from above, small, for the corner of a picture: points grey, the camera's path
/// blue, the camera a green wedge (red where it was when it is lost), a bar of a round length.
///
/// Thread: one.
class MapInset {
 public:
  /// Remembers where the camera was.
  void add(const FrameReport& report);
  /// The map that the camera is in, or was in last; a dark picture while there is none.
  ColourImage draw(const Atlas& atlas, int width_px, int height_px) const;

 private:
  std::vector<TrajectoryEntry> path_;  ///< of tracked frames
  bool lost_ = false;
};

}  // namespace ydd
