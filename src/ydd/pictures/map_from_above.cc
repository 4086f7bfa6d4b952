// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/map_from_above.h"

#include <utility>

namespace ydd {
namespace {

Eigen::Vector2d from_above(const Eigen::Vector3d& p_world) { return {p_world.x(), p_world.z()}; }

std::vector<Eigen::Vector2d> points_of(const Atlas& atlas, MapId map, std::size_t most) {
  std::vector<Eigen::Vector2d> out;
  const std::size_t step = atlas.points().size() / most + 1;
  std::size_t count = 0;
  atlas.points().for_each([&](MapPointId, const MapPoint& point) {
    if (count++ % step != 0 || point.observations.empty()) return;
    if (atlas.map_of(point.observations.front().keyframe) != map) return;
    out.push_back(from_above(point.p_world));
  });
  return out;
}

/// The map's keyframes and loops.
MapFromAbove skeleton_of(const Atlas& atlas, MapId map) {
  MapFromAbove out;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    if (keyframe.map != map) return;
    const Eigen::Vector2d here = from_above(keyframe.T_world_camera.translation());
    out.keyframes.push_back(here);
    for (const KeyFrameId other : keyframe.loops) {
      const KeyFrame* const there = atlas.find(other);
      if (!there || there->serial > keyframe.serial) continue;  // once per pair
      out.loops.emplace_back(from_above(there->T_world_camera.translation()), here);
    }
  });
  return out;
}

}  // namespace

MapFromAbove map_from_above(const Atlas& atlas, std::span<const TrajectoryEntry> path,
                            std::size_t most_points) {
  if (path.empty()) return {};
  const MapId map = atlas.map_of(path.back().reference);
  MapFromAbove out = skeleton_of(atlas, map);
  out.points = points_of(atlas, map, most_points);
  for (const TrajectoryEntry& entry : path) {
    const auto T_world_reference = atlas.T_world_keyframe(entry.reference);
    if (!T_world_reference || atlas.map_of(entry.reference) != map) continue;
    const SE3 T_world_camera = *T_world_reference * entry.T_reference_camera;
    out.path.push_back(from_above(T_world_camera.translation()));
    out.path_stamps.push_back(entry.stamp);
    out.ahead = from_above(T_world_camera.rotation() * Eigen::Vector3d::UnitZ());
  }
  return out;
}

}  // namespace ydd
