// SPDX-License-Identifier: Apache-2.0
#include "ydd/matching/gathered_bundle.h"

namespace ydd {

void add_pose(const Atlas& atlas, KeyFrameId id, bool fixed, PoseIndex& index,
              GatheredBundle& gathered) {
  index.set(id, static_cast<int>(gathered.keyframes.size()));
  gathered.keyframes.push_back(id);
  gathered.problem.poses.push_back({atlas.at(id).T_world_camera.inverse(), fixed});
}

void add_point(const Atlas& atlas, MapPointId id, GatheredBundle& gathered) {
  gathered.points.push_back(id);
  gathered.problem.points.push_back(atlas.at(id).p_world);
}

void add_observations(const Atlas& atlas, const PoseIndex& index, GatheredBundle& gathered) {
  for (int p = 0; p < static_cast<int>(gathered.points.size()); ++p) {
    for (const Observation& o :
         atlas.at(gathered.points[static_cast<std::size_t>(p)]).observations) {
      if (!index.has(o.keyframe)) continue;
      const Features& f = atlas.at(o.keyframe).features();
      const auto octave =
          static_cast<std::size_t>(f.keypoints[static_cast<std::size_t>(o.keypoint)].octave);
      gathered.problem.observations.push_back(
          {index.of(o.keyframe), p, uvr_px(f, o.keypoint), atlas.scales().inv_sigma2[octave]});
    }
  }
}

}  // namespace ydd
