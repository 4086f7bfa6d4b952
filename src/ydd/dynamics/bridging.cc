// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/bridging.h"

#include <algorithm>

#include "ydd/detection/boxes.h"

namespace ydd {
namespace {

Box expected_box(const BodyTrack& track) {
  return {track.box.x0 + track.dx_px, track.box.y0 + track.dy_px, track.box.x1 + track.dx_px,
          track.box.y1 + track.dy_px};
}

/// The track of each body, -1: none; best overlap first.
std::vector<int> match(std::span<const BodyTrack> tracks, std::span<const MovingRegion> bodies,
                       double least_overlap) {
  struct Pair {
    float overlap;
    int body, track;
  };
  std::vector<Pair> pairs;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (std::size_t t = 0; t < tracks.size(); ++t) {
      const float overlap = intersection_over_union(bodies[b].box, expected_box(tracks[t]));
      if (overlap >= least_overlap) {
        pairs.push_back({overlap, static_cast<int>(b), static_cast<int>(t)});
      }
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.overlap > b.overlap; });
  std::vector<int> track_of(bodies.size(), -1);
  std::vector<bool> taken(tracks.size(), false);
  for (const Pair& pair : pairs) {
    if (track_of[pair.body] >= 0 || taken[pair.track]) continue;
    track_of[pair.body] = pair.track;
    taken[pair.track] = true;
  }
  return track_of;
}

BodyTrack seen_again(const BodyTrack* before, const MovingRegion& body) {
  BodyTrack track;
  track.box = body.box;
  track.range = body.range;
  if (before == nullptr) return track;
  if (before->missed > 0) {
    // The box was carried on meanwhile: where it ended says nothing about the motion now.
    track.dx_px = before->dx_px;
    track.dy_px = before->dy_px;
  } else {
    track.dx_px = (body.box.x0 + body.box.x1 - before->box.x0 - before->box.x1) / 2;
    track.dy_px = (body.box.y0 + body.box.y1 - before->box.y0 - before->box.y1) / 2;
  }
  track.seen = before->seen + 1;
  return track;
}

bool in_image(const Box& box, int width_px, int height_px) {
  const Box seen = clipped(box, static_cast<float>(width_px), static_cast<float>(height_px));
  return seen.width() >= 1 && seen.height() >= 1;
}

}  // namespace

Bridging bridge(std::span<const BodyTrack> tracks, std::span<const MovingRegion> bodies,
                int image_width_px, int image_height_px, const BridgingOptions& options) {
  Bridging result;
  const std::vector<int> track_of = match(tracks, bodies, options.overlap);
  std::vector<bool> seen(tracks.size(), false);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyTrack* before = track_of[b] >= 0 ? &tracks[track_of[b]] : nullptr;
    if (before != nullptr) seen[track_of[b]] = true;
    result.tracks.push_back(seen_again(before, bodies[b]));
  }
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    BodyTrack track = tracks[t];
    track.box = expected_box(track);
    ++track.missed;
    if (seen[t] || track.missed > options.frames || track.seen < options.seen ||
        !in_image(track.box, image_width_px, image_height_px)) {
      continue;
    }
    result.regions.push_back({-1, Rule::bridged, track.box, track.range});
    result.tracks.push_back(track);
  }
  return result;
}

}  // namespace ydd
