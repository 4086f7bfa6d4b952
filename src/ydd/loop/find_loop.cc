// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "ydd/loop/loop_closer.h"
#include "ydd/tracking/pose_from_matches.h"

namespace ydd {
namespace {

constexpr int kNeighbourhood = 30;        // keyframes around the matched one
constexpr double kGuidedRadius_px = 2.0;  // factor of the local search
constexpr std::size_t kWitnesses = 5;     // neighbours asked for consistency

/// A keyframe as the tracker sees a frame, with nothing known about it.
TrackedFrame as_frame(const KeyFrame& keyframe) {
  TrackedFrame frame;
  frame.index = keyframe.frame_index;
  frame.stamp = keyframe.stamp;
  frame.observations = keyframe.observations;
  frame.grid = keyframe.grid;
  frame.points.assign(keyframe.features().size(), MapPointId{});
  return frame;
}

/// Keyframes that share points with `id`, itself, and their best neighbours: seeing these again is
/// no news.
std::set<KeyFrameId> connected(const Atlas& atlas, KeyFrameId id) {
  std::set<KeyFrameId> out{id};
  for (const Covisible& c : atlas.at(id).covisible) {
    out.insert(c.keyframe);
    const auto& second = atlas.at(c.keyframe).covisible;
    for (std::size_t i = 0; i < second.size() && i < 10; ++i) out.insert(second[i].keyframe);
  }
  return out;
}

/// How similar a picture of the same place is: the least similar of the strongest neighbours.
double neighbour_score(const Atlas& atlas, const KeyFrame& keyframe) {
  double least = 1.0;
  for (std::size_t i = 0; i < keyframe.covisible.size() && i < 5; ++i) {
    const KeyFrame& other = atlas.at(keyframe.covisible[i].keyframe);
    if (other.words) least = std::min(least, similarity(*keyframe.words, *other.words));
  }
  return keyframe.covisible.empty() ? 0.0 : least;
}

/// Whether the neighbour, moved along with `current`, sees the matched part of the map too.
bool witnesses(const Atlas& atlas, KeyFrameId neighbour, const LoopMatch& match,
               const LocalMap& matched_part, const LoopOptions& options) {
  const KeyFrame& keyframe = atlas.at(neighbour);
  const SE3 T_current_neighbour =
      atlas.at(match.current).T_world_camera.inverse() * keyframe.T_world_camera;
  TrackedFrame frame = as_frame(keyframe);
  frame.T_camera_world = (match.T_world_current * T_current_neighbour).inverse();
  const LocalSearch search =
      search_local_map(atlas, matched_part, frame, kGuidedRadius_px, MatchLimits());
  const PoseFromMatches pose =
      pose_from_matches(atlas.camera(), atlas.scales(), frame.features(), frame.T_camera_world,
                        search.matches, PoseOnlyOptions());
  const SE3 moved = pose.T_camera_world * frame.T_camera_world.inverse();
  const bool stayed = moved.translation().norm() < 0.1 && moved.angle_rad() < 0.05;
  return stayed && static_cast<int>(pose.inliers.size()) >= options.consistent_inliers;
}

bool is_consistent(const Atlas& atlas, const LoopMatch& match, const std::vector<MapPointId>& seen,
                   const LoopOptions& options) {
  const LocalMap matched_part = gather_local_map(atlas, seen, match.matched, kNeighbourhood);
  int agreeing = 0;
  const auto& neighbours = atlas.at(match.current).covisible;
  for (std::size_t i = 0; i < neighbours.size() && i < kWitnesses; ++i) {
    if (witnesses(atlas, neighbours[i].keyframe, match, matched_part, options) &&
        ++agreeing >= options.consistent_keyframes) {
      return true;
    }
  }
  return agreeing >= options.consistent_keyframes;
}

}  // namespace

std::optional<LoopMatch> find_loop(const Atlas& atlas, KeyFrameId current,
                                   const LoopOptions& options) {
  const KeyFrame* keyframe = atlas.find(current);
  if (!keyframe || !keyframe->words || !options.enabled) return std::nullopt;
  const std::set<KeyFrameId> known = connected(atlas, current);
  const auto admit = [&](KeyFrameId id) {
    const KeyFrame& other = atlas.at(id);
    const bool old =
        other.map != keyframe->map || other.serial + options.min_age_keyframes <= keyframe->serial;
    return old && !known.contains(id);
  };
  const double least = options.min_score_ratio * neighbour_score(atlas, *keyframe);
  const TrackedFrame frame = as_frame(*keyframe);
  for (const PlaceCandidate& candidate :
       query_places(atlas, *keyframe->words, admit, static_cast<std::size_t>(options.candidates))) {
    if (candidate.score < least) break;
    RelocalizationOptions relocalization = options.match;
    relocalization.min_inliers = options.min_inliers;
    const auto found = relocalize(atlas, frame, std::span(&candidate.keyframe, 1), relocalization,
                                  PoseOnlyOptions(), MatchLimits());
    if (!found) continue;
    std::vector<MapPointId> seen;
    for (const PointMatch& m : found->inliers) seen.push_back(m.point);
    const LoopMatch match{current, candidate.keyframe, found->T_camera_world.inverse(),
                          static_cast<int>(found->inliers.size())};
    if (is_consistent(atlas, match, seen, options)) return match;
  }
  return std::nullopt;
}

}  // namespace ydd
