// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/matching/tracked_frame.h"
#include "ydd/optimization/pose_only.h"

namespace ydd {

/// Pose optimisation over matches: gathers, solves, and keeps the matches that agree. Without
/// `use_depth` the frame's own depth counts for nothing.
struct PoseFromMatches {
  SE3 T_camera_world;
  std::vector<PointMatch> inliers;
};
PoseFromMatches pose_from_matches(const Camera& camera, const PyramidScales& scales,
                                  const Features& features, const SE3& T_camera_world_initial,
                                  const std::vector<PointMatch>& matches,
                                  const PoseOnlyOptions& options, bool use_depth = true);

}  // namespace ydd
