// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "ydd/base/id.h"
#include "ydd/base/timestamp.h"
#include "ydd/features/features.h"
#include "ydd/features/matching.h"
#include "ydd/features/vocabulary.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// Which keypoint of which keyframe saw a map point.
struct Observation {
  KeyFrameId keyframe;  ///< that saw it
  int keypoint = 0;     ///< index into the keyframe's features
  friend bool operator==(const Observation&, const Observation&) = default;
};

/// A landmark: a plain immutable value that names keyframes by id.
struct MapPoint {
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();  ///< metres
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();   ///< mean unit direction camera -> point
  /// Distances between which the extractor's pyramid can show the point, metres.
  double min_distance_m = 0;
  double max_distance_m = 0;  ///< beyond it, it would be too small
  Descriptor descriptor{};    ///< that of its observations which is nearest to all of them
  std::vector<Observation> observations;  ///< at most one per keyframe, in order of addition
  std::int64_t born = 0;                  ///< serial of the keyframe that created it
  int visible = 1;                        ///< frames in which it should have been seen
  int found = 1;                          ///< frames in which it was seen
};

/// Another keyframe that sees the same points.
struct Covisible {
  KeyFrameId keyframe;  ///< that sees them too
  int weight = 0;       ///< number of shared points
  friend bool operator==(const Covisible&, const Covisible&) = default;
};

/// What a keyframe keeps of its picture for a dense cloud: half as wide and high as the image (not
/// undistorted), everything that was judged to move cut out of both.
struct KeyFramePicture {
  int width_px = 0;         ///< of the picture
  int height_px = 0;        ///< of the picture
  std::string colour_jpeg;  ///< neutral grey where there is no depth
  std::string depth_png;    ///< 16 bit, millimetres along the optical axis; 0: none, or cut out
  friend bool operator==(const KeyFramePicture&, const KeyFramePicture&) = default;
};

/// A frame that the map keeps: a plain immutable value that names points by id.
struct KeyFrame {
  std::int64_t serial = 0;                          ///< order of creation; never reused
  std::int64_t frame_index = 0;                     ///< which frame of its run it was
  Timestamp stamp;                                  ///< of that frame
  MapId map;                                        ///< which map of the atlas it belongs to
  SE3 T_world_camera;                               ///< as bundle adjustment and loops have left it
  std::shared_ptr<const Features> shared_features;  ///< what was judged static, and only that
  std::shared_ptr<const KeypointGrid> grid;         ///< over the features
  std::vector<MapPointId> points;                   ///< per keypoint; empty id: none
  KeyFrameId parent;                 ///< in the spanning tree; empty for a map's first
  std::vector<KeyFrameId> children;  ///< those whose parent it is, in the order of their ids
  std::vector<Covisible> covisible;  ///< heaviest first; ties by serial

  std::vector<KeyFrameId> loops;                   ///< keyframes it closed a loop with
  std::shared_ptr<const BagOfWords> words;         ///< what it looks like, for place recognition
  std::shared_ptr<const KeyFramePicture> picture;  ///< null: not kept

  /// One for each entry of `points`.
  const Features& features() const { return *shared_features; }
};

/// Where a keyframe stood that is no longer kept, so that trajectories always resolve.
struct CulledKeyFrame {
  KeyFrameId parent;      ///< that it hung on when it was taken out
  SE3 T_parent_keyframe;  ///< where it stood in the frame of its parent
};

}  // namespace ydd
