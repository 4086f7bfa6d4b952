// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/localise.h"

#include <memory>
#include <utility>

#include "ydd/features/orb_extractor.h"
#include "ydd/tracking/tracker.h"

namespace ydd {

std::optional<Located> localise(const Atlas& atlas, const RgbdFrame& frame,
                                const SystemOptions& options) {
  const SystemOptions resolved = options.resolved();
  const Camera& camera = atlas.camera();
  OrbExtractor extractor(resolved.orb);
  TrackedFrame tracked;
  tracked.index = frame.index;
  tracked.stamp = frame.stamp;
  tracked.shared_features = std::make_shared<const Features>(with_geometry(
      extractor.extract(frame.grey, resolved.dynamics.compensation.points), camera, frame.depth_m));
  tracked.grid = std::make_shared<const KeypointGrid>(*tracked.shared_features, camera);
  Tracker tracker(resolved.tracking, true);
  tracker.set_localization_only(true);
  const TrackResult found = tracker.track(std::move(tracked), atlas, true);
  if (found.state != TrackingState::tracking) return std::nullopt;
  return Located{found.T_world_camera, atlas.map_of(found.reference), found.inliers};
}

}  // namespace ydd
