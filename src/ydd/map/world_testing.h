// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "ydd/map/atlas.h"

/// A world of points with descriptors, seen without pictures: for the tests of map, tracking,
/// mapping and system.
namespace ydd::testing_world {

/// What there is to see. World frame: that of a camera at the origin, x right, y down, z forward.
struct PointWorld {
  Camera camera;
  PyramidScales scales = PyramidScales::make(8, 1.2);
  std::vector<Eigen::Vector3d> p_world;  ///< metres
  std::vector<Descriptor> descriptors;   ///< random: about 128 bits from each other
  std::vector<float> angles_rad;
  std::vector<double> farthest_m;  ///< a point is found on octave 0 from here, not beyond
};

/// One look at it.
struct View {
  SE3 T_world_camera;
  std::shared_ptr<const Features> shared_features;
  std::shared_ptr<const KeypointGrid> grid;
  std::vector<int> shown;  ///< per keypoint: index into the world's points

  const Features& features() const { return *shared_features; }
};

struct ViewOptions {
  double noise_px = 0.0;            ///< standard deviation on octave 0, grows with the octave
  double depth_noise = 0.0;         ///< standard deviation at 1 m, grows with its square
  int flipped_bits = 0;             ///< of each descriptor, at random places
  double seen_share = 1.0;          ///< of the points in view
  double depth_reading_m = 4.0;     ///< farther points come without depth
  int from_point = 0, points = -1;  ///< only these points of the world; -1: all that follow
  unsigned seed = 1;
};

inline Descriptor random_descriptor(std::mt19937_64& random) {
  return {random(), random(), random(), random()};
}

/// Points in a box before the camera, 1.5 to 5 m away.
inline PointWorld make_world(int points, unsigned seed) {
  PointWorld world;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < points; ++i) {
    const double x_m = 7.0 * unit(random) - 3.5;
    const double y_m = 5.0 * unit(random) - 2.5;
    const double z_m = 1.5 + 3.5 * unit(random);
    world.p_world.emplace_back(x_m, y_m, z_m);
    world.descriptors.push_back(random_descriptor(random));
    world.angles_rad.push_back(static_cast<float>(2.0 * std::numbers::pi * unit(random)));
    // Octaves 0 to 3 from the origin.
    world.farthest_m.push_back(world.p_world.back().norm() *
                               std::exp((0.6 + 3.3 * unit(random)) * world.scales.log_step));
  }
  return world;
}

/// Octave on which the extractor would find point `i`, or -1 when it is too far or too near.
inline int octave_at(const PointWorld& world, std::size_t i, double distance_m) {
  const double steps = std::log(world.farthest_m[i] / distance_m) / world.scales.log_step;
  const int octave = static_cast<int>(std::floor(steps));
  return octave < world.scales.levels() ? octave : -1;
}

inline View look(const PointWorld& world, const SE3& T_world_camera,
                 const ViewOptions& options = {}) {
  std::mt19937_64 random(options.seed * 7919U + 17U);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const Camera& camera = world.camera;
  const SE3 T_camera_world = T_world_camera.inverse();
  Features f;
  View view;
  const int end = options.points < 0 ? static_cast<int>(world.p_world.size())
                                     : options.from_point + options.points;
  for (int point = options.from_point; point < end; ++point) {
    const auto i = static_cast<std::size_t>(point);
    const Eigen::Vector3d p_camera = T_camera_world * world.p_world[i];
    if (p_camera.z() < 0.3 || unit(random) > options.seen_share) continue;
    const int octave = octave_at(world, i, p_camera.norm());
    if (octave < 0) continue;
    const double sigma_px =
        options.noise_px * world.scales.factor[static_cast<std::size_t>(octave)];
    Eigen::Vector2d px = camera.project(p_camera);
    const double v = normal(random);
    px += sigma_px * Eigen::Vector2d(normal(random), v);
    if (!camera.contains(px)) {
      continue;
    }
    const double z_m =
        p_camera.z() + options.depth_noise * p_camera.z() * p_camera.z() * normal(random);
    const bool reading = p_camera.z() <= options.depth_reading_m;
    Descriptor descriptor = world.descriptors[i];
    for (int k = 0; k < options.flipped_bits; ++k) {
      const std::uint64_t bit = random() % 256U;
      descriptor[bit / 64U] ^= std::uint64_t{1} << (bit % 64U);
    }
    f.keypoints.push_back({static_cast<float>(px.x()), static_cast<float>(px.y()),
                           world.angles_rad[i], 50.0F, octave});
    f.descriptors.push_back(descriptor);
    f.undistorted_px.push_back(px.cast<float>());
    f.depth_m.push_back(reading ? static_cast<float>(z_m) : 0.0F);
    f.right_px.push_back(reading ? static_cast<float>(px.x() - camera.bf() / z_m) : -1.0F);
    view.shown.push_back(point);
  }
  view.T_world_camera = T_world_camera;
  view.grid = std::make_shared<const KeypointGrid>(f, camera);
  view.shared_features = std::make_shared<const Features>(std::move(f));
  return view;
}

/// A keyframe of a view, without points.
inline KeyFrame keyframe_of(const View& view, std::int64_t frame_index = 0) {
  KeyFrame keyframe;
  keyframe.frame_index = frame_index;
  keyframe.stamp = {1'000'000'000 + frame_index * 33'333'333};
  keyframe.T_world_camera = view.T_world_camera;
  keyframe.shared_features = view.shared_features;
  keyframe.grid = view.grid;
  return keyframe;
}

/// An atlas that was built from exact knowledge: every keypoint linked to the point it shows.
struct BuiltMap {
  Atlas atlas;
  std::vector<KeyFrameId> keyframes;  ///< per view
  std::vector<MapPointId> points;     ///< per point of the world; empty id: never seen
};

inline BuiltMap build_map(const PointWorld& world, const std::vector<View>& views,
                          int min_covisible_weight = 15) {
  BuiltMap built{Atlas(world.camera, world.scales), {}, {}};
  built.points.resize(world.p_world.size());
  const MapId map = built.atlas.new_map();
  for (std::size_t v = 0; v < views.size(); ++v) {
    KeyFrame keyframe = keyframe_of(views[v], static_cast<std::int64_t>(v));
    keyframe.map = map;
    const KeyFrameId id = built.atlas.add_keyframe(std::move(keyframe));
    built.keyframes.push_back(id);
    for (std::size_t k = 0; k < views[v].shown.size(); ++k) {
      const auto i = static_cast<std::size_t>(views[v].shown[k]);
      if (built.points[i].valid()) {
        built.atlas.add_observation(built.points[i], id, static_cast<int>(k));
      } else {
        built.points[i] = built.atlas.add_point(world.p_world[i], id, static_cast<int>(k));
      }
    }
    built.atlas.refresh_covisibility(id, min_covisible_weight);
  }
  for (const MapPointId id : built.points) {
    if (id.valid()) built.atlas.refresh_point(id);
  }
  return built;
}

/// A hand-held motion: sways `sway_m` about the origin and turns a little, period 4 s.
inline SE3 hand_held(double time_s, double sway_m = 0.3) {
  const double phase_rad = 0.5 * std::numbers::pi * time_s;
  Vector6d twist;
  twist << sway_m * std::sin(phase_rad), 0.5 * sway_m * (1.0 - std::cos(phase_rad)),
      0.3 * sway_m * std::sin(2.0 * phase_rad), 0.05 * std::sin(phase_rad),
      0.10 * sway_m * std::sin(phase_rad), 0.05 * std::sin(2.0 * phase_rad);
  return SE3::exp(twist);
}

}  // namespace ydd::testing_world
