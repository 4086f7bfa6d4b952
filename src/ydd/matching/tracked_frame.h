// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ydd/cloud/keyframe_picture.h"
#include "ydd/evidence/motion_odds.h"
#include "ydd/map/local_map.h"
#include "ydd/reckoning/dead_reckoning.h"

namespace ydd {

/// One frame as the tracker works on it: what was seen, where the camera is believed to be, and
/// which map point each keypoint shows.
struct TrackedFrame {
  std::int64_t index = 0;
  Timestamp stamp;
  std::shared_ptr<const Features> shared_features;
  std::shared_ptr<const KeypointGrid> grid;
  std::shared_ptr<const PictureSource> picture;  ///< for a keyframe to keep; null: none
  std::shared_ptr<const MotionOdds> odds;        ///< that its surfaces move; null: not asked for
  std::optional<ReckonedMotion> reckoned;        ///< since the last seen pose, by other senses
  SE3 T_camera_world;
  std::vector<MapPointId> points;  ///< per keypoint; empty id: none
  bool stale = false;  ///< one of its pictures is an earlier frame's: it makes no keyframe
  std::string doubt;   ///< why its pictures are not to be believed; empty: no reason

  const Features& features() const { return *shared_features; }
};

/// A keyframe as the tracker sees a frame, with nothing known about it.
inline TrackedFrame as_frame(const KeyFrame& keyframe) {
  TrackedFrame frame;
  frame.index = keyframe.frame_index;
  frame.stamp = keyframe.stamp;
  frame.shared_features = keyframe.shared_features;
  frame.grid = keyframe.grid;
  frame.points.assign(keyframe.features().size(), MapPointId{});
  return frame;
}

/// A point in the world that the frame might see, and how it was matched.
struct PointMatch {
  int keypoint = 0;         ///< of the frame
  Eigen::Vector3d p_world;  ///< metres
  MapPointId point;         ///< empty for a point made from the last frame's depth alone
  int distance = 0;         ///< Hamming
  int source = 0;           ///< keypoint of the last frame or keyframe, or local point
};

}  // namespace ydd
