// SPDX-License-Identifier: Apache-2.0
#include "ydd/matching/projection_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ydd/matching/viewpoint.h"

namespace ydd {
namespace {

constexpr std::size_t kUsualCandidates = 64;  // keypoints in a search window, at most as a rule

constexpr double kStraightOnCosine = 0.998;

/// Keeps, per keypoint of the frame, only the match with the least distance.
std::vector<PointMatch> one_per_keypoint(std::vector<PointMatch> matches, std::size_t keypoints) {
  std::vector<int> best(keypoints, -1);
  for (int i = 0; i < static_cast<int>(matches.size()); ++i) {
    int& owner = best[static_cast<std::size_t>(matches[static_cast<std::size_t>(i)].keypoint)];
    if (owner < 0 || matches[static_cast<std::size_t>(i)].distance <
                         matches[static_cast<std::size_t>(owner)].distance) {
      owner = i;
    }
  }
  std::vector<PointMatch> out;
  out.reserve(matches.size());
  for (const int i : best) {
    if (i >= 0) out.push_back(matches[static_cast<std::size_t>(i)]);
  }
  return out;
}

/// Drops matches whose change of orientation disagrees with that of most.
std::vector<PointMatch> with_consistent_rotation(const std::vector<PointMatch>& matches,
                                                 const std::vector<float>& angle_difference_rad) {
  const std::vector<bool> keep = consistent_rotation(angle_difference_rad);
  std::vector<PointMatch> out;
  out.reserve(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (keep[i]) out.push_back(matches[i]);
  }
  return out;
}

/// With a depth reading, the virtual right coordinate must agree as well.
bool right_agrees(const Camera& camera, const Features& features, int keypoint, double u_px,
                  double z_m, double radius_px) {
  const float right_px = features.right_px[static_cast<std::size_t>(keypoint)];
  return right_px < 0 || std::abs(u_px - camera.bf() / z_m - right_px) <= radius_px;
}

struct LastPoint {
  Eigen::Vector3d p_world;
  MapPointId id;
};

/// The world point behind keypoint `i` of the last frame; false if it has none.
bool last_point(const Atlas& atlas, const TrackedFrame& last, const SE3& T_world_last,
                std::size_t i, double close_depth_m, LastPoint& out) {
  if (const MapPoint* point = atlas.find(last.points[i])) {
    out = {point->p_world, last.points[i]};
    return true;
  }
  const Features& f = last.features();
  if (!f.has_depth(i) || f.depth_m[i] > close_depth_m) return false;
  out = {T_world_last * atlas.camera().unproject(f.undistorted_px[i].cast<double>(), f.depth_m[i]),
         {}};
  return true;
}

}  // namespace

void MatchLimits::describe(OptionTable& t) {
  t.add("loose", loose, {0, 256}, "bit", "descriptor distance accepted near a predicted place");
  t.add("strict", strict, {0, 256}, "bit", "descriptor distance accepted without a prediction");
  t.add("ratio", ratio, {0.1, 1.0}, "", "best to second best distance on the same octave");
}

std::vector<PointMatch> search_last_frame(const Atlas& atlas, const TrackedFrame& last,
                                          const TrackedFrame& frame, double radius_px,
                                          double close_depth_m, const MatchLimits& limits) {
  const Camera& camera = atlas.camera();
  const Features& from = last.features();
  const Features& to = frame.features();
  const SE3 T_world_last = last.T_camera_world.inverse();
  std::vector<PointMatch> matches;
  matches.reserve(from.size());
  std::vector<int> candidates;
  candidates.reserve(kUsualCandidates);
  LastPoint point;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!last_point(atlas, last, T_world_last, i, close_depth_m, point)) continue;
    const Eigen::Vector3d p_camera = frame.T_camera_world * point.p_world;
    if (p_camera.z() <= 0) continue;
    const Eigen::Vector2d px = camera.project(p_camera);
    if (!camera.contains(px)) continue;
    const int octave = from.keypoints[i].octave;
    const double radius = radius_px * atlas.scales().factor[static_cast<std::size_t>(octave)];
    frame.grid->query(static_cast<float>(px.x()), static_cast<float>(px.y()),
                      static_cast<float>(radius), octave - 1, octave + 1, candidates);
    std::erase_if(candidates, [&](int k) {
      return !right_agrees(camera, to, k, px.x(), p_camera.z(), radius);
    });
    const BestMatch best = best_match(from.descriptors[i], to, candidates);
    if (best.index < 0 || best.distance > limits.loose) continue;
    matches.push_back({best.index, point.p_world, point.id, best.distance, static_cast<int>(i)});
  }
  matches = one_per_keypoint(std::move(matches), to.size());
  std::vector<float> turns_rad;
  turns_rad.reserve(matches.size());
  turns_rad.reserve(matches.size());
  for (const PointMatch& m : matches) {
    turns_rad.push_back(from.keypoints[static_cast<std::size_t>(m.source)].angle_rad -
                        to.keypoints[static_cast<std::size_t>(m.keypoint)].angle_rad);
  }
  return with_consistent_rotation(matches, turns_rad);
}

LocalSearch search_local_map(const Atlas& atlas, const LocalMap& local, const TrackedFrame& frame,
                             double radius_px, const MatchLimits& limits) {
  const Camera& camera = atlas.camera();
  const Features& features = frame.features();
  const Viewpoint viewpoint(camera, atlas.scales(), frame.T_camera_world);
  std::vector<bool> taken_slot(atlas.points().slots(), false);
  for (const MapPointId id : frame.points) {
    if (atlas.find(id)) taken_slot[id.slot] = true;
  }
  LocalSearch out;
  out.visible.reserve(local.points.size());
  out.matches.reserve(frame.points.size());
  std::vector<int> candidates;
  candidates.reserve(kUsualCandidates);
  for (int i = 0; i < static_cast<int>(local.points.size()); ++i) {
    const LocalPoint& point = local.points[static_cast<std::size_t>(i)];
    if (point.id.slot < taken_slot.size() && taken_slot[point.id.slot]) continue;
    const auto seen = viewpoint.see(point);
    if (!seen) continue;
    out.visible.push_back(i);
    // A point seen straight on is where it is predicted; seen from the side, its patch deforms.
    const double radius = radius_px * (seen->view_cosine > kStraightOnCosine ? 2.5 : 4.0) *
                          atlas.scales().factor[static_cast<std::size_t>(seen->octave)];
    frame.grid->query(static_cast<float>(seen->px.x()), static_cast<float>(seen->px.y()),
                      static_cast<float>(radius), seen->octave - 1, seen->octave, candidates);
    std::erase_if(candidates, [&](int k) {
      return frame.points[static_cast<std::size_t>(k)].valid() ||
             !right_agrees(camera, features, k, seen->px.x(), seen->z_m, radius);
    });
    const BestMatch best = best_match(point.descriptor, features, candidates);
    if (best.index < 0 || best.distance > limits.loose) continue;
    if (best.octave == best.second_octave && best.distance > limits.ratio * best.second_distance) {
      continue;
    }
    out.matches.push_back({best.index, point.p_world, point.id, best.distance, i});
  }
  out.matches = one_per_keypoint(std::move(out.matches), features.size());
  return out;
}

std::vector<PointMatch> match_keyframe(const Atlas& atlas, KeyFrameId id, const TrackedFrame& frame,
                                       double ratio, const MatchLimits& limits) {
  const KeyFrame& keyframe = atlas.at(id);
  const Features& to = frame.features();
  std::vector<int> all(to.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<PointMatch> matches;
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    const MapPoint* point = atlas.find(keyframe.points[i]);
    if (!point) continue;
    const BestMatch best = best_match(keyframe.features().descriptors[i], to, all);
    if (best.index < 0 || best.distance > limits.strict) continue;
    if (best.distance > ratio * best.second_distance) continue;
    matches.push_back(
        {best.index, point->p_world, keyframe.points[i], best.distance, static_cast<int>(i)});
  }
  matches = one_per_keypoint(std::move(matches), to.size());
  std::vector<float> turns_rad;
  turns_rad.reserve(matches.size());
  for (const PointMatch& m : matches) {
    turns_rad.push_back(
        keyframe.features().keypoints[static_cast<std::size_t>(m.source)].angle_rad -
        to.keypoints[static_cast<std::size_t>(m.keypoint)].angle_rad);
  }
  return with_consistent_rotation(matches, turns_rad);
}

}  // namespace ydd
