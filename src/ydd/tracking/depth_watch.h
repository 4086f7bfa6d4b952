// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/matching/pose_from_matches.h"
#include "ydd/tracking/doubt.h"

namespace ydd {

/// Whether the depth image of a frame can be believed: it must agree with the map where the colour
/// image alone says that the camera is.
///
/// Depth that stands still, comes late, is constant or noise does not. What is usual follows from
/// the frames before: sensors differ, and so do maps.
class DepthWatch {
 public:
  explicit DepthWatch(const DoubtOptions& options) : options_(options) {}

  /// What the frame's depth says of points whose place the colour image agrees with.
  struct Verdict {
    bool doubtful = false;
    double off_per_m = 0;    ///< median of |depth - expected depth| / expected depth^2, 1/m
    PoseFromMatches colour;  ///< the pose by colour alone; without inliers when nothing was judged
  };
  /// Who is in doubt already believes less. `matches` are the frame's keypoints with map points,
  /// `T_camera_world` its pose with depth.
  Verdict check(const Camera& camera, const PyramidScales& scales, const Features& features,
                const SE3& T_camera_world, const std::vector<PointMatch>& matches,
                const PoseOnlyOptions& pose_options, bool in_doubt) const;

  /// A frame that is believed tells what is usual.
  void learn(const Verdict& verdict);
  /// What was doubtful for too long is what this sensor gives now.
  void give_in(const Verdict& verdict) { usual_per_m_ = verdict.off_per_m; }

 private:
  DoubtOptions options_;
  double usual_per_m_ = 0;  ///< of the medians
  int learnt_ = 0;          ///< frames
};

/// The frame without its depth.
TrackedFrame colour_only(TrackedFrame frame);

}  // namespace ydd
