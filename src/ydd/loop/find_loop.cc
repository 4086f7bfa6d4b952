// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <utility>

#include "ydd/loop/loop_closer.h"
#include "ydd/matching/pose_from_matches.h"

namespace ydd {
namespace {

constexpr int kNeighbourhood = 30;        // keyframes around the matched one
constexpr double kGuidedRadius_px = 2.0;  // factor of the local search
constexpr std::size_t kWitnesses = 5;     // neighbours asked for consistency

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
      search_local_map(atlas, matched_part, frame, kGuidedRadius_px, options.limits);
  const PoseFromMatches pose =
      pose_from_matches(atlas.camera(), atlas.scales(), frame.features(), frame.T_camera_world,
                        search.matches, options.pose);
  const SE3 moved = pose.T_camera_world * frame.T_camera_world.inverse();
  const bool stayed = moved.translation().norm() < 0.1 && moved.angle_rad() < 0.05;
  return stayed && static_cast<int>(pose.inliers.size()) >= options.consistent_inliers;
}

bool is_consistent(const Atlas& atlas, const LoopMatch& match, const LoopOptions& options) {
  const LocalMap matched_part = gather_local_map(atlas, match.seen, match.matched, kNeighbourhood);
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

/// The shortest way between two keyframes of a map along shared points, the spanning tree and
/// loops, metres: what drift between them can have come from. A room that is visited again and
/// again does not drift from its neighbour, however long the camera walks.
/// (Dijkstra, "A note on two problems in connexion with graphs", 1959.)
double path_length_m(const Atlas& atlas, KeyFrameId from, KeyFrameId to) {
  using Reached = std::pair<double, KeyFrameId>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> front;
  std::map<KeyFrameId, double> best{{from, 0.0}};
  front.push({0.0, from});
  while (!front.empty()) {
    const auto [reached_m, id] = front.top();
    front.pop();
    if (id == to) return reached_m;
    if (reached_m > best.at(id)) continue;
    const KeyFrame& keyframe = atlas.at(id);
    const auto step = [&, reached_m = reached_m](KeyFrameId next) {
      const KeyFrame* other = atlas.find(next);
      if (!other || other->map != keyframe.map) return;
      const double there_m =
          reached_m +
          (other->T_world_camera.translation() - keyframe.T_world_camera.translation()).norm();
      const auto [entry, is_new] = best.try_emplace(next, there_m);
      if (!is_new && entry->second <= there_m) return;
      entry->second = there_m;
      front.push({there_m, next});
    };
    for (const Covisible& c : keyframe.covisible) step(c.keyframe);
    for (const KeyFrameId next : keyframe.loops) step(next);
    for (const KeyFrameId next : keyframe.children) step(next);
    step(keyframe.parent);
  }
  return std::numeric_limits<double>::infinity();
}

/// Whether odometry can be as wrong as the match says.
bool is_plausible_drift(const Atlas& atlas, const LoopMatch& match, const LoopOptions& options) {
  const KeyFrame& current = atlas.at(match.current);
  const KeyFrame& matched = atlas.at(match.matched);
  if (current.map != matched.map) return true;
  const double length_m = path_length_m(atlas, match.matched, match.current);
  const SE3 drift = current.T_world_camera.inverse() * match.T_world_current;
  return drift.translation().norm() <= options.max_drift_m + options.max_drift_share * length_m &&
         drift.angle_rad() <=
             options.max_turn_drift_rad + options.max_turn_drift_rad_per_m * length_m;
}

/// Keyframes in which a loop may be found, best first, one a place.
std::vector<KeyFrameId> loop_candidates(const Atlas& atlas, KeyFrameId current,
                                        const LoopOptions& options,
                                        const std::function<bool(KeyFrameId)>& among) {
  const KeyFrame& keyframe = atlas.at(current);
  const std::set<KeyFrameId> known = connected(atlas, current);
  const auto admit = [&](KeyFrameId id) {
    const KeyFrame& other = atlas.at(id);
    const bool old =
        other.map != keyframe.map || other.serial + options.min_age_keyframes <= keyframe.serial;
    return old && !known.contains(id) && (!among || among(id));
  };
  constexpr std::size_t kPerPlace = 6;  // keyframes of one place that look much the same
  const auto wanted = static_cast<std::size_t>(options.candidates);
  const double least = options.min_score_ratio * neighbour_score(atlas, keyframe);
  const auto similar = query_places(atlas, *keyframe.words, admit, kPerPlace * wanted);
  std::vector<KeyFrameId> out;
  for (const PlaceCandidate& place : distinct_places(atlas, similar, wanted)) {
    if (place.score >= least) out.push_back(place.keyframe);
  }
  return out;
}

/// The match with one candidate, as far as the two keyframes alone can tell.
std::optional<LoopMatch> match_candidate(const Atlas& atlas, KeyFrameId current, KeyFrameId id,
                                         const std::vector<KeyFrameId>& rivals,
                                         const LoopOptions& options) {
  RelocalizationOptions relocalization = options.match;
  relocalization.min_inliers = options.min_inliers;
  const TrackedFrame frame = as_frame(atlas.at(current));
  const bool other_map = atlas.at(id).map != atlas.at(current).map;
  const auto found = other_map ? relocalize_uniquely(atlas, frame, rivals, relocalization,
                                                     options.pose, options.limits)
                               : relocalize(atlas, frame, std::span(&id, 1), relocalization,
                                            options.pose, options.limits);
  if (!found) return std::nullopt;
  LoopMatch match{current, found->keyframe, found->T_camera_world.inverse(), {}};
  for (const PointMatch& m : found->inliers) match.seen.push_back(m.point);
  return match;
}

}  // namespace

std::optional<LoopMatch> find_loop(const Atlas& atlas, KeyFrameId current,
                                   const LoopOptions& options,
                                   const std::function<bool(KeyFrameId)>& among) {
  const KeyFrame* keyframe = atlas.find(current);
  if (!keyframe || !keyframe->words || !options.enabled) return std::nullopt;
  const std::vector<KeyFrameId> candidates = loop_candidates(atlas, current, options, among);
  for (const KeyFrameId candidate : candidates) {
    auto match = match_candidate(atlas, current, candidate, candidates, options);
    if (match && is_plausible_drift(atlas, *match, options) &&
        is_consistent(atlas, *match, options)) {
      return match;
    }
  }
  return std::nullopt;
}

}  // namespace ydd
