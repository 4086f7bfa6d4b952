// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ydd/matching/tracked_frame.h"

namespace ydd {

/// Limits of the descriptor distances (bits of 256).
struct MatchLimits {
  int loose = 100;     ///< where geometry confines the search
  int strict = 50;     ///< where it does not
  double ratio = 0.8;  ///< best to second best, same octave
  void describe(OptionTable& table);
};

/// Searches the points of the last frame near where the predicted pose of `frame` projects them:
/// its map points (at their position in `atlas`) and, for keypoints without one, points from the
/// last frame's own depth up to `close_depth_m`. One match per keypoint; rotations must agree.
std::vector<PointMatch> search_last_frame(const Atlas& atlas, const TrackedFrame& last,
                                          const TrackedFrame& frame, double radius_px,
                                          double close_depth_m, const MatchLimits& limits);

/// What became of the local map's points in a frame.
struct LocalSearch {
  std::vector<PointMatch> matches;
  std::vector<int> visible;  ///< indices into LocalMap::points of points that should be seen
};

/// Searches the local map's points that the pose of `frame` brings into view and that are not among
/// `frame.points` yet.
LocalSearch search_local_map(const Atlas& atlas, const LocalMap& local, const TrackedFrame& frame,
                             double radius_px, const MatchLimits& limits);

/// Matches the map points of a keyframe to the frame by descriptor alone (no pose needed): best to
/// second best must be below `ratio`, rotations must agree.
std::vector<PointMatch> match_keyframe(const Atlas& atlas, KeyFrameId keyframe,
                                       const TrackedFrame& frame, double ratio,
                                       const MatchLimits& limits);

}  // namespace ydd
