// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/followed_objects.h"

#include <utility>

namespace ydd {

std::optional<SE3> correction_since(const PlacedFrame& frame, const Atlas& atlas) {
  const std::optional<SE3> T_world_reference = atlas.T_world_keyframe(frame.reference);
  if (!T_world_reference) return std::nullopt;
  return *T_world_reference * frame.T_reference_camera * frame.T_world_camera.inverse();
}

FollowedObjects::FollowedObjects(const Camera& camera, ObjectCatalogue catalogue,
                                 const SensorNoise& noise, const WorldTrackOptions& options)
    : camera_(camera),
      catalogue_(std::move(catalogue)),
      noise_(noise),
      options_(options),
      tracker_(options) {}

std::vector<WorldTrack> FollowedObjects::see(Timestamp stamp, const SightedFrame& frame,
                                             const Atlas& atlas, const PlacedFrame& place) {
  follow_map(atlas);
  if (last_ && atlas.map_of(last_->reference) != atlas.map_of(place.reference)) tracker_.clear();
  tracker_.see(stamp, place.T_world_camera,
               find_sightings(frame, camera_, catalogue_, noise_, options_));
  last_ = place;
  return tracker_.tracks();
}

std::vector<WorldTrack> FollowedObjects::coast(Timestamp stamp, const Atlas& atlas) {
  follow_map(atlas);
  tracker_.coast(stamp);
  return tracker_.tracks();
}

void FollowedObjects::clear() {
  tracker_.clear();
  last_.reset();
}

/// The pose of a frame is that of the map which it was tracked in; what the mapper has published
/// since counts from the next frame on.
void FollowedObjects::follow_map(const Atlas& atlas) {
  if (!last_) return;
  const std::optional<SE3> correction = correction_since(*last_, atlas);
  if (!correction) return;
  tracker_.move(*correction);
  last_->T_world_camera = *correction * last_->T_world_camera;
}

}  // namespace ydd
