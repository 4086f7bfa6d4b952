// SPDX-License-Identifier: Apache-2.0
#include "ydd/matching/pose_from_matches.h"

namespace ydd {

PoseFromMatches pose_from_matches(const Camera& camera, const PyramidScales& scales,
                                  const Features& features, const SE3& T_camera_world_initial,
                                  const std::vector<PointMatch>& matches,
                                  const PoseOnlyOptions& options, bool use_depth) {
  std::vector<PoseObservation> observations;
  observations.reserve(matches.size());
  for (const PointMatch& m : matches) {
    const auto octave =
        static_cast<std::size_t>(features.keypoints[static_cast<std::size_t>(m.keypoint)].octave);
    Eigen::Vector3d seen_px = uvr_px(features, m.keypoint);
    if (!use_depth) seen_px.z() = -1;  // no reading
    observations.push_back({m.p_world, seen_px, scales.inv_sigma2[octave]});
  }
  const PoseOnlyResult solved =
      optimize_pose(camera, T_camera_world_initial, observations, options);
  PoseFromMatches out;
  out.T_camera_world = solved.T_camera_world;
  out.inliers.reserve(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (solved.inlier[i] != 0) out.inliers.push_back(matches[i]);
  }
  return out;
}

}  // namespace ydd
