// SPDX-License-Identifier: Apache-2.0
#include "ydd/loop/loop_closer.h"

namespace ydd {
namespace {

struct Gathered {
  BundleProblem problem;
  std::vector<KeyFrameId> keyframes;
  std::vector<MapPointId> points;
};

Gathered gather(const Atlas& atlas, MapId map) {
  Gathered out;
  std::vector<int> pose_by_slot(atlas.keyframes().slots(), -1);
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    if (keyframe.map != map) return;
    pose_by_slot[id.slot] = static_cast<int>(out.keyframes.size());
    out.keyframes.push_back(id);
    out.problem.poses.push_back({keyframe.T_world_camera.inverse(), atlas.is_first(id)});
  });
  atlas.points().for_each([&](MapPointId id, const MapPoint& point) {
    const int index = static_cast<int>(out.points.size());
    bool seen = false;
    for (const Observation& s : point.observations) {
      const int pose = pose_by_slot[s.keyframe.slot];
      if (pose < 0) continue;
      seen = true;
      const Features& f = atlas.at(s.keyframe).features();
      const auto octave =
          static_cast<std::size_t>(f.keypoints[static_cast<std::size_t>(s.keypoint)].octave);
      out.problem.observations.push_back(
          {pose, index, uvr_px(f, s.keypoint), atlas.scales().inv_sigma2[octave]});
    }
    if (!seen) return;
    out.points.push_back(id);
    out.problem.points.push_back(point.p_world);
  });
  return out;
}

}  // namespace

std::optional<Correction> full_bundle(const Atlas& atlas, KeyFrameId member,
                                      const LoopOptions& options, const std::stop_token& stop) {
  const KeyFrame* keyframe = atlas.find(member);
  if (!keyframe) return std::nullopt;
  const Gathered gathered = gather(atlas, keyframe->map);
  const BundleResult solved = solve_bundle(atlas.camera(), gathered.problem, options.bundle, stop);
  if (solved.interrupted) return std::nullopt;
  Correction correction;
  correction.revision = atlas.revision();
  for (std::size_t i = 0; i < gathered.keyframes.size(); ++i) {
    correction.T_world_keyframe[gathered.keyframes[i]] = solved.T_camera_world[i].inverse();
  }
  for (std::size_t i = 0; i < gathered.points.size(); ++i) {
    correction.p_world[gathered.points[i]] = solved.points[i];
  }
  return correction;
}

}  // namespace ydd
