// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "ydd/dynamics/dynamics_options.h"
#include "ydd/dynamics/point_rules.h"
#include "ydd/objects/object_tracker.h"

namespace ydd {

/// The persons of a sequence: who is who from frame to frame, and where those are that the detector
/// missed (beyond the article, which names missed detections as its weakness). Thread: one.
class PersonTracks {
 public:
  /// `bodies` are the regions of the persons detected in the next frame; each is given its `track`.
  /// The result are regions for persons that were missed in it (rule `bridged`, object -1), as deep
  /// as when they were last seen.
  std::vector<MovingRegion> follow(std::span<MovingRegion> bodies, int image_width_px,
                                   int image_height_px, const BridgingOptions& options);
  void clear();

  const std::vector<ObjectTrack>& tracks() const { return tracker_.tracks(); }

 private:
  ObjectTracker tracker_;
  std::map<std::int64_t, std::optional<DepthRange>> range_;  ///< of each track when last seen
};

}  // namespace ydd
