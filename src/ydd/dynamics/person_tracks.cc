// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/person_tracks.h"

#include <algorithm>

namespace ydd {

std::vector<MovingRegion> PersonTracks::follow(std::span<MovingRegion> bodies, int image_width_px,
                                               int image_height_px,
                                               const BridgingOptions& options) {
  std::vector<Box> boxes;
  for (const MovingRegion& body : bodies) boxes.push_back(body.box);
  tracker_.update(boxes, image_width_px, image_height_px,
                  {options.overlap, options.seen, options.frames});
  std::vector<MovingRegion> missed;
  std::map<std::int64_t, std::optional<DepthRange>> range;
  for (const ObjectTrack& track : tracker_.tracks()) {
    if (track.found >= 0) {
      MovingRegion& body = bodies[static_cast<std::size_t>(track.found)];
      body.track = track.id;
      range[track.id] = body.range;
    } else {
      range[track.id] = range_.at(track.id);
      missed.push_back({-1, Rule::bridged, track.box, range[track.id], track.id});
    }
  }
  range_ = std::move(range);
  return missed;
}

void PersonTracks::clear() {
  tracker_.clear();
  range_.clear();
}

}  // namespace ydd
