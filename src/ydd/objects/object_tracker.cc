// SPDX-License-Identifier: Apache-2.0
#include "ydd/objects/object_tracker.h"

#include <algorithm>

#include "ydd/detection/boxes.h"

namespace ydd {
namespace {

Box expected_box(const ObjectTrack& track) {
  return {track.box.x0 + track.dx_px, track.box.y0 + track.dy_px, track.box.x1 + track.dx_px,
          track.box.y1 + track.dy_px};
}

ObjectTrack seen_again(const ObjectTrack& before, const Box& box) {
  ObjectTrack track = before;
  track.box = box;
  track.missed = 0;
  ++track.seen;
  // A box that was carried on meanwhile says nothing about the motion now by where it ended.
  if (before.missed == 0) {
    track.dx_px = (box.x0 + box.x1 - before.box.x0 - before.box.x1) / 2;
    track.dy_px = (box.y0 + box.y1 - before.box.y0 - before.box.y1) / 2;
  }
  return track;
}

bool in_image(const Box& box, int width_px, int height_px) {
  const Box seen = clipped(box, static_cast<float>(width_px), static_cast<float>(height_px));
  return seen.width() >= 1 && seen.height() >= 1;
}

}  // namespace

std::vector<int> associate(std::span<const Box> boxes, std::span<const Box> expected,
                           double least_overlap,
                           const std::function<bool(std::size_t, std::size_t)>& may_be_one) {
  struct Pair {
    float overlap;
    std::size_t box, expected;
  };
  std::vector<Pair> pairs;
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    for (std::size_t e = 0; e < expected.size(); ++e) {
      const float overlap = intersection_over_union(boxes[b], expected[e]);
      if (overlap < least_overlap || (may_be_one && !may_be_one(b, e))) continue;
      pairs.push_back({overlap, b, e});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.overlap > b.overlap; });
  std::vector<int> expected_of(boxes.size(), -1);
  std::vector<bool> taken(expected.size(), false);
  for (const Pair& pair : pairs) {
    if (expected_of[pair.box] >= 0 || taken[pair.expected]) continue;
    expected_of[pair.box] = static_cast<int>(pair.expected);
    taken[pair.expected] = true;
  }
  return expected_of;
}

void ObjectTracker::update(std::span<const Box> boxes, int image_width_px, int image_height_px,
                           const TrackOptions& options) {
  std::vector<Box> expected;
  expected.reserve(tracks_.size());
  for (const ObjectTrack& track : tracks_) expected.push_back(expected_box(track));
  const std::vector<int> track_of = associate(boxes, expected, options.overlap);
  std::vector<bool> seen(tracks_.size(), false);
  std::vector<ObjectTrack> after;
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    if (const int t = track_of[b]; t >= 0) {
      seen[static_cast<std::size_t>(t)] = true;
      after.push_back(seen_again(tracks_[static_cast<std::size_t>(t)], boxes[b]));
    } else {
      after.push_back({.id = next_id_++, .box = boxes[b]});
    }
    after.back().found = static_cast<int>(b);
  }
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    ObjectTrack track = tracks_[t];
    track.box = expected[t];
    track.found = -1;
    ++track.missed;
    if (!seen[t] && track.missed <= options.missed && track.seen >= options.seen &&
        in_image(track.box, image_width_px, image_height_px)) {
      after.push_back(track);
    }
  }
  tracks_ = std::move(after);
}

}  // namespace ydd
