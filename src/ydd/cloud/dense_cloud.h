// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/image/image.h"
#include "ydd/map/atlas.h"

namespace ydd {

/// A point of a dense cloud.
struct CloudPoint {
  Eigen::Vector3f p_world;  ///< metres
  Bgr colour{};             ///< mean of what was averaged into it
};

/// How keyframes' pictures become a cloud.
struct DenseCloudOptions {
  double voxel_m = 0.02;      ///< edge of the cubes in which points are averaged
  double max_depth_m = 4.0;   ///< farther readings of a camera like a Kinect are too coarse
  int witnesses = 6;          ///< covisible keyframes that are asked about each point, ...
  int latest_witnesses = 16;  ///< ... and the last of all that came after
  bool redact = false;        ///< grey from pictures that may show people (people_left_out)
};

/// What one keyframe adds to the cloud.
struct KeyframeCloud {
  KeyFrameId keyframe;             ///< whose picture it is made of
  Eigen::Vector3f origin;          ///< of its camera, world
  std::vector<CloudPoint> points;  ///< of the static scene, world frame
};

/// The static scene as the pictures of one map's keyframes show it, keyframe by keyframe in slot
/// order; those without a picture are passed over.
///
/// A point is dropped when more of the keyframe's best covisible neighbours look through it than
/// see it: what moved without being detected stands in free space for everyone who came earlier or
/// later. It is dropped, too, when the last two who say anything of it look through it: a chair
/// that stood there on an earlier visit. Failure: the first picture that cannot be opened.
Result<void> for_each_keyframe_cloud(const Atlas& atlas, MapId map,
                                     const DenseCloudOptions& options,
                                     const std::function<void(const KeyframeCloud&)>& visit);

/// The same as one cloud: position and colour averaged in each cube, cubes in order of x, y, z.
/// Deterministic.
Result<std::vector<CloudPoint>> dense_cloud(const Atlas& atlas, MapId map,
                                            const DenseCloudOptions& options);

}  // namespace ydd
