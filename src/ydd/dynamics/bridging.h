// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ydd/dynamics/dynamics_options.h"
#include "ydd/dynamics/point_rules.h"

namespace ydd {

/// A body that has been seen in the last frames.
struct BodyTrack {
  Box box;                          ///< in the last frame, seen or carried on
  float dx_px = 0, dy_px = 0;       ///< motion of the box centre from frame to frame
  std::optional<DepthRange> range;  ///< when last seen; none: full rejection
  int seen = 1;                     ///< frames in which it was detected
  int missed = 0;                   ///< frames since
};

/// The tracks after a frame, and regions for the bodies that were missed in it.
struct Bridging {
  std::vector<BodyTrack> tracks;
  std::vector<MovingRegion> regions;  ///< rule `bridged`, object -1
};

/// Carries bodies over frames in which the detector missed them (beyond the article, which names
/// missed detections as its weakness). `bodies` are the regions of the persons detected in this
/// frame. A track goes to the body that overlaps its expected box most, at least by
/// `overlap` (intersection over union). A track without a body that was seen in `seen` frames gives
/// a region at its expected box for at most `frames` frames, then it ends; so does one that leaves
/// the image.
Bridging bridge(std::span<const BodyTrack> tracks, std::span<const MovingRegion> bodies,
                int image_width_px, int image_height_px, const BridgingOptions& options);

}  // namespace ydd
