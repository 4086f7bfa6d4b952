// SPDX-License-Identifier: Apache-2.0
// What the tracker knows when it decides whether a frame becomes a keyframe.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "ydd/tracking/tracker.h"

namespace ydd {
namespace {

/// Median of the depth readings; infinite when there is none.
double median_depth_m(const Features& features) {
  std::vector<float> depths_m;
  depths_m.reserve(features.size());
  for (const float depth_m : features.depth_m) {
    if (depth_m > 0) depths_m.push_back(depth_m);
  }
  if (depths_m.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = depths_m.begin() + static_cast<std::ptrdiff_t>(depths_m.size() / 2);
  std::nth_element(depths_m.begin(), middle, depths_m.end());
  return *middle;
}

}  // namespace

KeyframeSituation Tracker::situation(const Atlas& atlas, const TrackedFrame& frame,
                                     const TrackResult& result, bool mapper_idle) const {
  KeyframeSituation s;
  s.since_keyframe_s = seconds_between(last_candidate_stamp_, frame.stamp);
  s.inliers = result.inliers;
  // Points seen from one keyframe only are unproven, but a young map has no others.
  const std::size_t proven = atlas.keyframes().size() <= 2 ? 1 : 2;
  for (const MapPointId id : atlas.at(result.reference).points) {
    const MapPoint* point = atlas.find(id);
    if (point && point->observations.size() >= proven) {
      ++s.reference_points;
    }
  }
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const float depth_m = frame.features().depth_m[i];
    if (depth_m <= 0 || depth_m > options_.close_depth_m) continue;
    ++(frame.points[i].valid() ? s.close_tracked : s.close_untracked);
  }
  s.keyframes = static_cast<int>(atlas.keyframes().size());
  s.rotation_rad = result.T_reference_camera.angle_rad();
  const double depth_m = median_depth_m(frame.features());
  s.translation_share = result.T_reference_camera.translation().norm() / depth_m;
  s.mapper_idle = mapper_idle;
  s.known_place = is_known_place(atlas, frame, result, depth_m);
  return s;
}

bool Tracker::is_known_place(const Atlas& atlas, const TrackedFrame& frame,
                             const TrackResult& result, double depth_m) const {
  const KeyframePolicyOptions& options = options_.keyframe;
  const auto stands_here = [&](KeyFrameId id) {
    const KeyFrame& keyframe = atlas.at(id);
    if (std::abs(seconds_between(keyframe.stamp, frame.stamp)) < options.revisit_s) return false;
    const SE3 T_keyframe_camera = keyframe.T_world_camera.inverse() * result.T_world_camera;
    return T_keyframe_camera.translation().norm() <= options.known_translation_share * depth_m &&
           T_keyframe_camera.angle_rad() <= options.known_rotation_rad;
  };
  const std::vector<Covisible>& around = atlas.at(result.reference).covisible;
  return stands_here(result.reference) ||
         std::any_of(around.begin(), around.end(),
                     [&](const Covisible& c) { return stands_here(c.keyframe); });
}

}  // namespace ydd
