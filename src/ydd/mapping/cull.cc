// SPDX-License-Identifier: Apache-2.0
#include "ydd/mapping/cull.h"

#include <cmath>

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

/// What the map would lose with a keyframe: the share of each of its points that is its own, by how
/// often the point is found when it should be. Points that few frames asked for count little.
double worth_of(const Atlas& atlas, const KeyFrame& keyframe) {
  constexpr double kUnproven = 10.0;  // frames
  double worth = 0;
  for (const MapPointId id : keyframe.points) {
    if (!id.valid()) continue;
    const MapPoint& point = atlas.at(id);
    worth += point.found /
             ((point.visible + kUnproven) * static_cast<double>(point.observations.size()));
  }
  return worth;
}

/// Those around `newest`, itself included, that look its way from where it stands.
std::vector<KeyFrameId> same_place(const Atlas& atlas, KeyFrameId newest,
                                   const CullOptions& options) {
  const KeyFrame& centre = atlas.at(newest);
  std::vector<KeyFrameId> out{newest};
  for (const Covisible& c : centre.covisible) {
    const SE3 T_centre_other =
        centre.T_world_camera.inverse() * atlas.at(c.keyframe).T_world_camera;
    if (T_centre_other.translation().norm() <= options.place_radius_m &&
        T_centre_other.angle_rad() <= options.place_rotation_rad) {
      out.push_back(c.keyframe);
    }
  }
  return out;
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
  t.add("place_keyframes", place_keyframes, {1, 1000}, "keyframes",
        "where a place is seen again, so many may stay in it");
  t.add("place_radius_m", place_radius_m, {0.0, 10.0}, "m", "how far a place reaches");
  t.add("place_rotation_rad", place_rotation_rad, {0.0, 3.2}, "rad",
        "keyframes of one place look at most so far apart");
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

int cull_crowded_place(Atlas& atlas, KeyFrameId newest, const CullOptions& options) {
  std::vector<KeyFrameId> place = same_place(atlas, newest, options);
  const Timestamp now = atlas.at(newest).stamp;
  const auto is_of_this_visit = [&](KeyFrameId id) {
    return std::abs(seconds_between(atlas.at(id).stamp, now)) < options.revisit_s;
  };
  int culled = 0;
  while (static_cast<int>(place.size()) > options.place_keyframes) {
    auto least = place.end();
    double least_worth = 0;
    for (auto it = place.begin(); it != place.end(); ++it) {
      if (is_of_this_visit(*it) || atlas.is_first(*it)) continue;
      const double worth = worth_of(atlas, atlas.at(*it));
      if (least != place.end() && worth >= least_worth) continue;
      least = it;
      least_worth = worth;
    }
    if (least == place.end()) break;
    atlas.cull_keyframe(*least);
    place.erase(least);
    ++culled;
  }
  return culled;
}

}  // namespace ydd
