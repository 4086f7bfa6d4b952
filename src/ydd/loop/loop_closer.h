// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <stop_token>

#include "ydd/map/correction.h"
#include "ydd/matching/relocalization.h"
#include "ydd/optimization/bundle_adjustment.h"
#include "ydd/optimization/pose_graph.h"
#include "ydd/place/place_query.h"

namespace ydd {

/// How loops are found and closed; describe() has the sentences.
struct LoopOptions {
  bool enabled = true;
  int candidates = 4;
  double min_score_ratio = 0.8;
  int min_age_keyframes = 10;
  int min_inliers = 40;
  int consistent_keyframes = 2;
  int consistent_inliers = 20;
  double max_drift_m = 0.2;
  double max_drift_share = 0.05;
  double max_turn_drift_rad = 0.1;
  double max_turn_drift_rad_per_m = 0.02;
  int essential_weight = 60;
  int graph_nodes = 1000;
  RelocalizationOptions match;
  MatchLimits limits{};    ///< those of tracking, set by the system
  PoseOnlyOptions pose{};  ///< likewise
  PoseGraphOptions graph;
  bool full_bundle = true;
  int bundle_keyframes = 600;
  BundleOptions bundle;
  void describe(OptionTable& table);
};

/// A place seen again: where the keyframe would stand if the older part of the map is right.
struct LoopMatch {
  KeyFrameId current;            ///< the keyframe that sees a known place
  KeyFrameId matched;            ///< the keyframe of the map that shows it already
  SE3 T_world_current;           ///< in the frame of the matched keyframe's map
  std::vector<MapPointId> seen;  ///< points of the matched part that agree
};

/// Looks for the place of `current` among older keyframes that share no points with it:
/// candidates by bag of words (at least nearly as similar as a covisible neighbour), then matches,
/// PnP, pose optimisation and guided search against the candidate's part of the map, then the same
/// relative pose must hold for neighbours of `current`. Nothing unless all agree.
///
/// Places that look alike pass all of this. Within one map odometry tells them apart: a loop that
/// asks for more correction than a camera can have drifted on its way from one keyframe to the
/// other is none. Between maps nothing is known, so the place must be unlike every other one.
/// With `among` only keyframes that it lets through are looked at.
std::optional<LoopMatch> find_loop(const Atlas& atlas, KeyFrameId current,
                                   const LoopOptions& options,
                                   const std::function<bool(KeyFrameId)>& among = {});

/// Spreads the correction of a loop over the map: pose-graph optimisation over the essential graph
/// (spanning tree, strong covisibility, earlier loops). If the match is in another map, the
/// older of the two stays and the younger is moved onto it rigidly. In a map of more than
/// `graph_nodes` keyframes, groups that hang together in the spanning tree move as one, but for
/// those at both ends of the loop: time grows with the map no more. Nothing if interrupted.
/// Mur-Artal and Tardos, "ORB-SLAM2", IEEE T-RO 2017, section III-D.
std::optional<Correction> correct_loop(const Atlas& atlas, const LoopMatch& match,
                                       const LoopOptions& options,
                                       const std::stop_token& stop = {});

/// Bundle adjustment over the whole map that `member` belongs to; in a map of more than
/// `bundle_keyframes` over so many around `member`, while the others stay. Interrupted, it gives
/// the best it has; nothing if that is no better than the map. `watch` as solve_bundle.
std::optional<Correction> full_bundle(const Atlas& atlas, KeyFrameId member,
                                      const LoopOptions& options, const std::stop_token& stop = {},
                                      const BundleWatch& watch = {});

}  // namespace ydd
