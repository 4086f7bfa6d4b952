// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/cull.h"

namespace ydd {
namespace {

int octave_of(const KeyFrame& keyframe, int keypoint) {
  return keyframe.features().keypoints[static_cast<std::size_t>(keypoint)].octave;
}

/// Whether `needed` keyframes other than `id` see the point on an octave not much coarser.
bool seen_well_elsewhere(const Atlas& atlas, const MapPoint& point, KeyFrameId id, int octave,
                         int needed) {
  int others = 0;
  for (const Observation& s : point.observations) {
    if (s.keyframe == id) continue;
    if (octave_of(atlas.at(s.keyframe), s.keypoint) <= octave + 1 && ++others >= needed)
      return true;
  }
  return false;
}

bool is_redundant(const Atlas& atlas, KeyFrameId id, const CullOptions& options) {
  const KeyFrame& keyframe = atlas.at(id);
  const Features& features = keyframe.features();
  int points = 0;
  int redundant = 0;
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    if (!keyframe.points[i].valid() || !features.has_depth(i) ||
        features.depth_m[i] > options.close_depth_m) {
      continue;
    }
    ++points;
    const MapPoint& point = atlas.at(keyframe.points[i]);
    if (static_cast<int>(point.observations.size()) > options.redundant_observations &&
        seen_well_elsewhere(atlas, point, id, features.keypoints[i].octave,
                            options.redundant_observations)) {
      ++redundant;
    }
  }
  return redundant > options.redundant_share * points;
}

}  // namespace

void CullOptions::describe(OptionTable& t) {
  t.add("min_found_ratio", min_found_ratio, {0.0, 1.0}, "",
        "share of the frames that should see a new point and find it");
  t.add("probation_keyframes", probation_keyframes, {0, 100}, "keyframes",
        "how long a new point is watched");
  t.add("contradicted_frames", contradicted_frames, {1, 100000}, "frames",
        "in a row in which a point is looked through or moves, that remove it");
  t.add("min_observations", min_observations, {1, 10}, "",
        "keyframes that must see a point by then");
  t.add("redundant_share", redundant_share, {0.1, 1.0}, "",
        "share of points seen elsewhere above which a keyframe is redundant");
  t.add("redundant_observations", redundant_observations, {1, 20}, "",
        "other keyframes that must see a point for that");
}

int cull_recent_points(Atlas& atlas, std::vector<MapPointId>& recent, KeyFrameId newest,
                       const CullOptions& options) {
  const std::int64_t now = atlas.at(newest).serial;
  int culled = 0;
  std::vector<MapPointId> still_recent;
  for (const MapPointId id : recent) {
    const MapPoint* point = atlas.find(id);
    if (!point) continue;
    const auto age = now - point->born;
    const bool rarely_found = point->found < options.min_found_ratio * point->visible;
    const bool unproven = age >= options.probation_keyframes &&
                          static_cast<int>(point->observations.size()) < options.min_observations;
    if (rarely_found || unproven) {
      atlas.remove_point(id);
      ++culled;
    } else if (age <= options.probation_keyframes) {
      still_recent.push_back(id);
    }
  }
  recent = std::move(still_recent);
  return culled;
}

int cull_contradicted_points(Atlas& atlas, std::span<const PointViews> views,
                             const CullOptions& options) {
  int removed = 0;
  for (const PointViews& v : views) {
    if (v.contradicted < options.contradicted_frames || !atlas.find(v.point)) continue;
    atlas.remove_point(v.point);
    ++removed;
  }
  return removed;
}

int cull_redundant_keyframes(Atlas& atlas, KeyFrameId newest, const CullOptions& options) {
  const std::vector<Covisible> neighbours = atlas.at(newest).covisible;
  int culled = 0;
  for (const Covisible& c : neighbours) {
    if (atlas.is_first(c.keyframe) || !is_redundant(atlas, c.keyframe, options)) continue;
    atlas.cull_keyframe(c.keyframe);
    ++culled;
  }
  return culled;
}

}  // namespace ydd
