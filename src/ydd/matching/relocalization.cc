// SPDX-License-Identifier: Apache-2.0
#include "ydd/matching/relocalization.h"

#include <algorithm>

#include "ydd/matching/pnp_ransac.h"
#include "ydd/matching/pose_from_matches.h"

namespace ydd {
namespace {

constexpr int kNeighbourhood = 30;        // keyframes around the recognised one
constexpr double kGuidedRadius_px = 3.0;  // the pose is rough before the guided search

void append_search(const LocalSearch& search, std::vector<PointMatch>& matches) {
  matches.insert(matches.end(), search.matches.begin(), search.matches.end());
}

std::optional<Relocalization> try_keyframe(const Atlas& atlas, TrackedFrame frame, KeyFrameId id,
                                           const RelocalizationOptions& options,
                                           const PoseOnlyOptions& pose_options,
                                           const MatchLimits& limits) {
  const Features& features = frame.features();
  const auto optimise = [&](const SE3& start, const std::vector<PointMatch>& matches) {
    return pose_from_matches(atlas.camera(), atlas.scales(), features, start, matches,
                             pose_options);
  };
  const auto matches = match_keyframe(atlas, id, frame, options.match_ratio, limits);
  if (static_cast<int>(matches.size()) < options.min_matches) return std::nullopt;
  const auto rough = pnp_ransac(atlas.camera(), features, matches,
                                {options.ransac_iterations, options.ransac_threshold_px,
                                 static_cast<unsigned>(options.seed)});
  if (!rough) return std::nullopt;
  PoseFromMatches pose = optimise(*rough, matches);
  if (static_cast<int>(pose.inliers.size()) < options.min_matches / 2) return std::nullopt;
  // Guided search: the rough pose brings the neighbourhood's points into view.
  std::vector<MapPointId> seeds;
  for (const PointMatch& m : pose.inliers) {
    frame.points[static_cast<std::size_t>(m.keypoint)] = m.point;
    seeds.push_back(m.point);
  }
  frame.T_camera_world = pose.T_camera_world;
  const LocalMap local = gather_local_map(atlas, seeds, id, kNeighbourhood);
  std::vector<PointMatch> all = pose.inliers;
  append_search(search_local_map(atlas, local, frame, kGuidedRadius_px, limits), all);
  pose = optimise(pose.T_camera_world, all);
  if (static_cast<int>(pose.inliers.size()) < options.min_inliers) return std::nullopt;
  return Relocalization{pose.T_camera_world, std::move(pose.inliers), id};
}

/// Two keyframes of one place lead to the same pose.
bool is_same_pose(const Relocalization& a, const Relocalization& b) {
  const SE3 apart = a.T_camera_world * b.T_camera_world.inverse();
  return apart.translation().norm() < 0.3 && apart.angle_rad() < 0.2;
}

}  // namespace

void RelocalizationOptions::describe(OptionTable& t) {
  t.add("match_ratio", match_ratio, {0.1, 1.0}, "", "best to second best descriptor distance");
  t.add("min_matches", min_matches, {4, 10000}, "", "descriptor matches needed to try a keyframe");
  t.add("ransac_iterations", ransac_iterations, {1, 100000}, "", "samples drawn at most");
  t.add("ransac_threshold_px", ransac_threshold_px, {0.1, 100.0}, "px", "inlier distance");
  t.add("min_inliers", min_inliers, {4, 10000}, "", "points that must agree in the end");
  t.add("rival_share", rival_share, {0.1, 1.0}, "",
        "a second place that reaches this share of the best one's points makes it ambiguous");
  t.add("seed", seed, {0, 2147483647}, "", "seed of the sampling");
}

std::optional<Relocalization> relocalize(const Atlas& atlas, const TrackedFrame& frame,
                                         std::span<const KeyFrameId> candidates,
                                         const RelocalizationOptions& options,
                                         const PoseOnlyOptions& pose_options,
                                         const MatchLimits& limits) {
  for (const KeyFrameId id : candidates) {
    if (!atlas.find(id)) continue;
    auto found = try_keyframe(atlas, frame, id, options, pose_options, limits);
    if (found) return found;
  }
  return std::nullopt;
}

std::optional<Relocalization> relocalize_uniquely(const Atlas& atlas, const TrackedFrame& frame,
                                                  std::span<const KeyFrameId> places,
                                                  const RelocalizationOptions& options,
                                                  const PoseOnlyOptions& pose_options,
                                                  const MatchLimits& limits) {
  std::optional<Relocalization> best;
  std::size_t rival = 0;  // points of the second best
  for (const KeyFrameId id : places) {
    if (!atlas.find(id)) continue;
    auto found = try_keyframe(atlas, frame, id, options, pose_options, limits);
    if (!found) continue;
    if (best && is_same_pose(*best, *found)) {
      if (found->inliers.size() > best->inliers.size()) best = std::move(found);
      continue;
    }
    if (best) rival = std::max(rival, std::min(best->inliers.size(), found->inliers.size()));
    if (!best || found->inliers.size() > best->inliers.size()) best = std::move(found);
  }
  if (best && static_cast<double>(rival) >=
                  options.rival_share * static_cast<double>(best->inliers.size())) {
    return std::nullopt;
  }
  return best;
}

}  // namespace ydd
