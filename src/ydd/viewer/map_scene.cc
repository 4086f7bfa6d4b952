// SPDX-License-Identifier: Apache-2.0
#include "ydd/viewer/map_scene.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "ydd/geometry/world_up.h"
#include "ydd/live/live_truth.h"

namespace ydd {
namespace {

constexpr int kLeastSharedPoints = 50;  // fewer would cover the map with lines
constexpr double kKeyframeSize_m = 0.06;
constexpr double kCameraSize_m = 0.16;
constexpr double kGridStep_m = 0.5;
constexpr int kGridHalfLines = 24;

SceneVertex vertex(const Eigen::Vector3d& p_world, Rgba colour) {
  return {{static_cast<float>(p_world.x()), static_cast<float>(p_world.y()),
           static_cast<float>(p_world.z())},
          colour};
}

void add_line(Vertices& lines, const Eigen::Vector3d& a, const Eigen::Vector3d& b, Rgba colour) {
  lines.push_back(vertex(a, colour));
  lines.push_back(vertex(b, colour));
}

/// The pyramid of what a camera sees, `depth_m` deep.
void add_pyramid(Vertices& lines, const SE3& T_world_camera, double half_width, double half_height,
                 double depth_m, Rgba colour) {
  std::array<Eigen::Vector3d, 4> corners;
  const std::array<std::pair<int, int>, 4> signs = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  for (std::size_t i = 0; i < 4; ++i) {
    corners[i] = T_world_camera * Eigen::Vector3d(signs[i].first * half_width * depth_m,
                                                  signs[i].second * half_height * depth_m, depth_m);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    add_line(lines, T_world_camera.translation(), corners[i], colour);
    add_line(lines, corners[i], corners[(i + 1) % 4], colour);
  }
}

MapId map_of(const Atlas& atlas, const MapPoint& point) {
  return point.observations.empty() ? MapId{} : atlas.map_of(point.observations.front().keyframe);
}

void add_points(const Atlas& atlas, MapId map, MapScene& scene) {
  scene.points.reserve(atlas.points().size());
  atlas.points().for_each([&](MapPointId, const MapPoint& point) {
    if (map_of(atlas, point) == map) {
      scene.points.push_back(vertex(point.p_world, scene_colour::kPoint));
    }
  });
  scene.point_count = static_cast<int>(scene.points.size());
}

void add_edges(const Atlas& atlas, const KeyFrame& keyframe, MapScene& scene) {
  const Eigen::Vector3d from = keyframe.T_world_camera.translation();
  const auto connect = [&](Vertices& lines, KeyFrameId id, Rgba colour) {
    const KeyFrame* other = atlas.find(id);
    // Both ends know the edge: the younger one draws it.
    if (!other || other->serial >= keyframe.serial || other->map != keyframe.map) return;
    add_line(lines, from, other->T_world_camera.translation(), colour);
  };
  for (const Covisible& c : keyframe.covisible) {
    if (c.weight >= kLeastSharedPoints) {
      connect(scene.covisibility, c.keyframe, scene_colour::kCovisibility);
    }
  }
  for (const KeyFrameId id : keyframe.loops) connect(scene.loops, id, scene_colour::kLoop);
}

std::vector<SE3> add_keyframes(const Atlas& atlas, MapId map, MapScene& scene) {
  std::vector<SE3> poses;
  std::set<MapId> maps;
  const Camera& camera = atlas.camera();
  const double half_width = 0.5 * camera.width_px / camera.fx_px;
  const double half_height = 0.5 * camera.height_px / camera.fy_px;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    maps.insert(keyframe.map);
    if (keyframe.map != map) return;
    poses.push_back(keyframe.T_world_camera);
    add_pyramid(scene.keyframes, keyframe.T_world_camera, half_width, half_height, kKeyframeSize_m,
                scene_colour::kKeyframe);
    add_edges(atlas, keyframe, scene);
  });
  scene.keyframe_count = static_cast<int>(poses.size());
  scene.maps = static_cast<int>(maps.size());
  return poses;
}

/// Lines from frame to frame; a gap where the camera was lost. Gives the poses that are drawn.
StampedPoses add_trajectory(const LiveFrame& live, MapId map, MapScene& scene) {
  StampedPoses poses;
  bool connected = false;
  live.history->for_each([&](auto, const LiveSample& sample) {
    const bool here =
        sample.state == TrackingState::tracking && live.atlas->map_of(sample.reference) == map;
    const auto T_world_reference =
        here ? live.atlas->T_world_keyframe(sample.reference) : std::nullopt;
    if (!T_world_reference) {
      connected = false;
      return;
    }
    const SE3 T_world_camera = *T_world_reference * sample.T_reference_camera;
    if (connected) {
      add_line(scene.trajectory, poses.back().T_world_camera.translation(),
               T_world_camera.translation(), scene_colour::kTrajectory);
    }
    poses.push_back({sample.stamp, T_world_camera});
    connected = true;
  });
  return poses;
}

void add_truth(const StampedPoses& trajectory, const StampedPoses& groundtruth, MapScene& scene) {
  const LiveTruth truth = align_live_truth(trajectory, groundtruth);
  for (std::size_t i = 0; i < truth.pairs.size(); ++i) {
    const TruthPair& pair = truth.pairs[i];
    add_line(scene.errors, pair.estimate, pair.truth, scene_colour::kError);
    if (i > 0) {
      add_line(scene.truth, truth.pairs[i - 1].truth, pair.truth, scene_colour::kTruth);
    }
  }
  scene.error_rmse_m = truth.rmse_m;
}

double quantile(std::vector<double> values, double share) {
  const auto n = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n), values.end());
  return values[n];
}

Eigen::Vector3d position(const SceneVertex& v) {
  return {v.p_world[0], v.p_world[1], v.p_world[2]};
}

/// A ball round most of what there is: a few points far away must not make the rest small.
void find_extent(const std::vector<SE3>& poses, MapScene& scene) {
  std::array<std::vector<double>, 3> coordinates;
  const auto add = [&](const Eigen::Vector3d& p) {
    for (int axis = 0; axis < 3; ++axis)
      coordinates[static_cast<std::size_t>(axis)].push_back(p[axis]);
  };
  for (const SceneVertex& v : scene.points) add(position(v));
  for (const SE3& T_world_camera : poses) add(T_world_camera.translation());
  if (coordinates[0].empty()) return;
  Eigen::Vector3d low;
  Eigen::Vector3d high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = quantile(coordinates[static_cast<std::size_t>(axis)], 0.05);
    high[axis] = quantile(coordinates[static_cast<std::size_t>(axis)], 0.95);
  }
  scene.centre = 0.5 * (low + high);
  scene.radius_m = std::max(0.5, 0.5 * (high - low).norm());
  for (const SE3& T_world_camera : poses) {
    scene.radius_m = std::max(scene.radius_m, (T_world_camera.translation() - scene.centre).norm());
  }
}

/// A floor: squares of half a metre below most of the points.
void add_grid(MapScene& scene) {
  if (scene.points.empty()) return;
  std::vector<double> heights_m;
  heights_m.reserve(scene.points.size());
  for (const SceneVertex& v : scene.points) heights_m.push_back(scene.up.dot(position(v)));
  const double floor_m = quantile(std::move(heights_m), 0.02);
  const Eigen::Vector3d side = scene.up.unitOrthogonal();
  const Eigen::Vector3d across = scene.up.cross(side);
  const Eigen::Vector3d middle = scene.centre + (floor_m - scene.up.dot(scene.centre)) * scene.up;
  const double reach_m = kGridStep_m * kGridHalfLines;
  for (int i = -kGridHalfLines; i <= kGridHalfLines; ++i) {
    const double at_m = kGridStep_m * i;
    add_line(scene.grid, middle + at_m * side - reach_m * across,
             middle + at_m * side + reach_m * across, scene_colour::kGrid);
    add_line(scene.grid, middle + at_m * across - reach_m * side,
             middle + at_m * across + reach_m * side, scene_colour::kGrid);
  }
}

constexpr double kStands_m_s = 0.05;  // slower than this shows no arrow

/// Edges of a box with these half axes.
void add_box(Vertices& lines, const Eigen::Vector3d& centre, const Eigen::Matrix3d& half_axes,
             Rgba colour) {
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d along = half_axes.col(axis);
    for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      const Eigen::Vector3d middle =
          centre + a * half_axes.col((axis + 1) % 3) + b * half_axes.col((axis + 2) % 3);
      add_line(lines, middle - along, middle + along, colour);
    }
  }
}

void add_arrow(Vertices& lines, const Eigen::Vector3d& from, const Eigen::Vector3d& way,
               const Eigen::Vector3d& up, Rgba colour) {
  const Eigen::Vector3d tip = from + way;
  const Eigen::Vector3d side = 0.12 * way.cross(up);
  add_line(lines, from, tip, colour);
  add_line(lines, tip, tip - 0.25 * way + side, colour);
  add_line(lines, tip, tip - 0.25 * way - side, colour);
}

/// A box stands upright, its width across the line of sight: extents are as the camera saw them.
void add_track(const WorldTrack& track, const SE3& T_now_told, const Eigen::Vector3d& eye,
               const Eigen::Vector3d& up, CurrentScene& scene) {
  constexpr double kLeast_m = 0.05;
  const Eigen::Vector3d centre = T_now_told * track.position_m;
  const Eigen::Vector3d sight = centre - eye;
  Eigen::Vector3d ahead = sight - sight.dot(up) * up;
  ahead = ahead.norm() > 1e-6 ? ahead.normalized() : up.unitOrthogonal();
  const Eigen::Vector3d half_m = 0.5 * track.extent_m.cwiseMax(kLeast_m);
  Eigen::Matrix3d half_axes;
  half_axes << half_m.x() * ahead.cross(up), half_m.y() * up, half_m.z() * ahead;
  Rgba colour = scene_colour::kTrack;
  if (track.unseen_s > 0) colour[3] = 110;
  add_box(scene.tracks, centre, half_axes, colour);
  if (track.velocity_m_s.norm() >= kStands_m_s) {
    add_arrow(scene.tracks, centre, T_now_told.rotation() * track.velocity_m_s, up, colour);
  }
  scene.labels.push_back(
      {centre + 1.1 * half_axes.col(1), track.class_name + " " + std::to_string(track.id), colour});
}

struct Tracked {
  KeyFrameId reference;  ///< empty: never tracked
  SE3 T_reference_camera;
};

/// Where the camera was known to be last.
Tracked last_tracked(const LiveFrame& live) {
  const TrackResult& track = live.report->track;
  if (track.state == TrackingState::tracking) return {track.reference, track.T_reference_camera};
  Tracked last;
  live.history->for_each([&](auto, const LiveSample& sample) {
    if (sample.reference.valid()) last = {sample.reference, sample.T_reference_camera};
  });
  return last;
}

}  // namespace

MapId current_map(const LiveFrame& live) {
  const KeyFrameId reference = last_tracked(live).reference;
  return live.atlas->map_of(reference.valid() ? reference : live.atlas->newest_keyframe());
}

MapScene build_map_scene(const LiveFrame& live, const StampedPoses& groundtruth) {
  MapScene scene;
  const MapId map = current_map(live);
  if (!map.valid()) return scene;
  const std::vector<SE3> poses = add_keyframes(*live.atlas, map, scene);
  add_points(*live.atlas, map, scene);
  add_truth(add_trajectory(live, map, scene), groundtruth, scene);
  scene.up = world_up(poses);
  find_extent(poses, scene);
  add_grid(scene);
  return scene;
}

CurrentScene build_current_scene(const LiveFrame& live, const Camera& camera,
                                 const Eigen::Vector3d& up) {
  CurrentScene scene;
  const auto [reference, T_reference_camera] = last_tracked(live);
  if (const auto T_world_reference = live.atlas->T_world_keyframe(reference)) {
    scene.T_world_camera = *T_world_reference * T_reference_camera;
  }
  for (const MapPointId id : live.report->points) {
    const MapPoint* point = live.atlas->find(id);
    if (point) scene.seen_points.push_back(vertex(point->p_world, scene_colour::kSeenPoint));
  }
  if (scene.T_world_camera) {
    const bool lost = live.report->track.state == TrackingState::lost;
    add_pyramid(scene.camera, *scene.T_world_camera, 0.5 * camera.width_px / camera.fx_px,
                0.5 * camera.height_px / camera.fy_px, kCameraSize_m,
                lost ? scene_colour::kLost : scene_colour::kTracking);
    // Tracks were told in the world as it was; the map may have been corrected since.
    const TrackResult& told = live.report->track;
    const SE3 T_now_told = told.state == TrackingState::tracking
                               ? *scene.T_world_camera * told.T_world_camera.inverse()
                               : SE3();
    for (const WorldTrack& track : live.report->tracks) {
      add_track(track, T_now_told, scene.T_world_camera->translation(), up, scene);
    }
  }
  return scene;
}

}  // namespace ydd
