// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "ydd/detection/detection.h"

namespace ydd {

/// One object, followed from frame to frame.
struct ObjectTrack {
  std::int64_t id = 0;         ///< of this object alone
  Box box;                     ///< in the last frame: as detected, or carried on
  float dx_px = 0, dy_px = 0;  ///< motion of the box's centre from frame to frame
  int seen = 1;                ///< frames in which it was detected
  int missed = 0;              ///< frames since
  int found = -1;              ///< index among the boxes of the last frame; -1: missed in it
};

/// When two boxes are one object, and how long one is missed.
struct TrackOptions {
  double overlap = 0.3;  ///< intersection over union that makes two boxes the same object
  int seen = 3;          ///< an object that is missed goes on if it was detected so often, ...
  int missed = 10;       ///< ... for at most so many frames
};

/// For each box the index of the expected box of the same object, or -1. Pairs with most overlap
/// come first, and no box is taken twice. `may_be_one(box, expected)` can forbid pairs; empty: none
/// is forbidden.
std::vector<int> associate(std::span<const Box> boxes, std::span<const Box> expected,
                           double least_overlap,
                           const std::function<bool(std::size_t, std::size_t)>& may_be_one = {});

/// Gives boxes of one kind an identity, a velocity and an age, and carries those on that a detector
/// misses for a few frames, each as fast as it was. One that leaves the image ends.
/// Thread: one. Deterministic.
class ObjectTracker {
 public:
  /// The boxes of the next frame.
  void update(std::span<const Box> boxes, int image_width_px, int image_height_px,
              const TrackOptions& options);
  void clear() { tracks_.clear(); }

  /// First those that were found, in the order of their boxes, then those that were missed.
  const std::vector<ObjectTrack>& tracks() const { return tracks_; }

 private:
  std::vector<ObjectTrack> tracks_;
  std::int64_t next_id_ = 0;
};

}  // namespace ydd
