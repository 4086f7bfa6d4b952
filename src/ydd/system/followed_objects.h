// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ydd/map/atlas.h"
#include "ydd/tracks/world_tracker.h"

namespace ydd {

/// Where a frame's camera was, in a map that may be corrected later.
struct PlacedFrame {
  KeyFrameId reference;
  SE3 T_reference_camera;
  SE3 T_world_camera;  ///< as it was believed then
};

/// How the world that the frame was placed in has been corrected since: p_now = result * p_then.
/// None when its keyframe is gone with its map.
std::optional<SE3> correction_since(const PlacedFrame& frame, const Atlas& atlas);

/// People and moving things in the newest state of the map that the camera is in: where the map is
/// corrected they go with it, where another map begins they end. Thread: one.
class FollowedObjects {
 public:
  FollowedObjects(const Camera& camera, ObjectCatalogue catalogue, const SensorNoise& noise,
                  const WorldTrackOptions& options);

  /// A frame with a pose that is believed.
  std::vector<WorldTrack> see(Timestamp stamp, const SightedFrame& frame, const Atlas& atlas,
                              const PlacedFrame& place);
  /// A frame without.
  std::vector<WorldTrack> coast(Timestamp stamp, const Atlas& atlas);
  void clear();

 private:
  void follow_map(const Atlas& atlas);

  Camera camera_;
  ObjectCatalogue catalogue_;
  SensorNoise noise_;
  WorldTrackOptions options_;
  WorldTracker tracker_;
  std::optional<PlacedFrame> last_;
};

}  // namespace ydd
