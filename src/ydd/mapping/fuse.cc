// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/fuse.h"

#include <algorithm>
#include <cmath>

#include "ydd/matching/viewpoint.h"

namespace ydd {
namespace {

/// Keypoint of the keyframe that shows the point, or -1.
int find_keypoint(const Atlas& atlas, const KeyFrame& keyframe, const Viewpoint& viewpoint,
                  const MapPoint& point, double radius_px, const MatchLimits& limits,
                  std::vector<int>& candidates) {
  const Camera& camera = atlas.camera();
  const auto visible = viewpoint.see(point);
  if (!visible) return -1;
  const Eigen::Vector2d& px = visible->px;
  const double scale = atlas.scales().factor[static_cast<std::size_t>(visible->octave)];
  const Features& f = keyframe.features();
  keyframe.grid->query(static_cast<float>(px.x()), static_cast<float>(px.y()),
                       static_cast<float>(radius_px * scale), visible->octave - 1, visible->octave,
                       candidates);
  // The reprojection must pass the same test as in bundle adjustment.
  std::erase_if(candidates, [&](int k) {
    const auto i = static_cast<std::size_t>(k);
    const Eigen::Vector3d seen = uvr_px(f, k);
    const double right_error_px =
        seen.z() < 0 ? 0.0 : px.x() - camera.bf() / visible->z_m - seen.z();
    const double error2 = (px - seen.head<2>()).squaredNorm() + right_error_px * right_error_px;
    const double chi2 =
        error2 * atlas.scales().inv_sigma2[static_cast<std::size_t>(f.keypoints[i].octave)];
    return chi2 > (seen.z() < 0 ? 5.991 : 7.815);
  });
  const BestMatch best = best_match(point.descriptor, f, candidates);
  return best.distance <= limits.strict ? best.index : -1;
}

/// Links or merges; the point that stays is the one with more observations.
void join(Atlas& atlas, KeyFrameId keyframe, int keypoint, MapPointId point) {
  const MapPointId present = atlas.at(keyframe).points[static_cast<std::size_t>(keypoint)];
  if (!present.valid()) {
    if (atlas.add_observation(point, keyframe, keypoint)) atlas.refresh_point(point);
    return;
  }
  const bool keep_present =
      atlas.at(present).observations.size() > atlas.at(point).observations.size();
  atlas.merge_points(keep_present ? point : present, keep_present ? present : point);
}

std::vector<KeyFrameId> neighbourhood(const Atlas& atlas, KeyFrameId id, int neighbours) {
  std::vector<KeyFrameId> out;
  const auto add = [&](KeyFrameId other) {
    if (other != id && std::find(out.begin(), out.end(), other) == out.end()) out.push_back(other);
  };
  const auto& direct = atlas.at(id).covisible;
  for (std::size_t i = 0; i < direct.size() && static_cast<int>(i) < neighbours; ++i) {
    add(direct[i].keyframe);
    const auto& second = atlas.at(direct[i].keyframe).covisible;
    for (std::size_t k = 0; k < second.size() && k < 5; ++k) add(second[k].keyframe);
  }
  return out;
}

std::vector<MapPointId> points_of(const Atlas& atlas, std::span<const KeyFrameId> keyframes) {
  std::vector<MapPointId> out;
  std::vector<bool> seen(atlas.points().slots(), false);
  for (const KeyFrameId id : keyframes) {
    for (const MapPointId point : atlas.at(id).points) {
      if (!point.valid() || seen[point.slot]) continue;
      seen[point.slot] = true;
      out.push_back(point);
    }
  }
  return out;
}

}  // namespace

int fuse_points(Atlas& atlas, KeyFrameId id, std::span<const MapPointId> points, double radius_px,
                const MatchLimits& limits) {
  const Viewpoint viewpoint(atlas.camera(), atlas.scales(), atlas.at(id).T_world_camera.inverse());
  std::vector<int> candidates;
  int fused = 0;
  for (const MapPointId point_id : points) {
    const MapPoint* point = atlas.find(point_id);
    if (!point) continue;
    const bool seen = std::any_of(point->observations.begin(), point->observations.end(),
                                  [&](const Observation& s) { return s.keyframe == id; });
    if (seen) continue;
    const int keypoint =
        find_keypoint(atlas, atlas.at(id), viewpoint, *point, radius_px, limits, candidates);
    if (keypoint < 0) continue;
    join(atlas, id, keypoint, point_id);
    ++fused;
  }
  return fused;
}

int fuse_with_neighbours(Atlas& atlas, KeyFrameId id, int neighbours, double radius_px,
                         int min_covisible_weight, const MatchLimits& limits) {
  const std::vector<KeyFrameId> others = neighbourhood(atlas, id, neighbours);
  const std::vector<MapPointId> own = points_of(atlas, std::span(&id, 1));
  int fused = 0;
  for (const KeyFrameId other : others) fused += fuse_points(atlas, other, own, radius_px, limits);
  const std::vector<MapPointId> theirs = points_of(atlas, others);
  fused += fuse_points(atlas, id, theirs, radius_px, limits);
  atlas.refresh_covisibility(id, min_covisible_weight);
  return fused;
}

}  // namespace ydd
