// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ydd/base/options.h"
#include "ydd/geometry/camera.h"
#include "ydd/simulation/motion_sensors.h"

namespace ydd {

/// How the camera moves: not at all, along or about its axes, on a half sphere, through rooms.
enum class PathKind { stationary, xyz, rpy, halfsphere, room_loop };
constexpr std::array<std::string_view, 5> choices_of(PathKind) {
  return {"static", "xyz", "rpy", "halfsphere", "room_loop"};
}
/// Depth as it is, or with the noise, the steps and the holes of a Kinect.
enum class DepthModel { exact, kinect };
constexpr std::array<std::string_view, 2> choices_of(DepthModel) { return {"exact", "kinect"}; }

/// What shines: ceiling lamps, always alike; daylight from a window; ceiling lamps, warm, at night;
/// lamps at the desks alone; one after the other.
enum class LightKind { steady, day, evening, lamps, changing };
constexpr std::array<std::string_view, 5> choices_of(LightKind) {
  return {"steady", "day", "evening", "lamps", "changing"};
}

/// Large things of no class that detectors know.
enum class MoverKind { none, cabinet, curtain, door, robot, screen };
constexpr std::array<std::string_view, 6> choices_of(MoverKind) {
  return {"none", "cabinet", "curtain", "door", "robot", "screen"};
}

/// Everything that makes a simulated sequence: the same options give the same bytes.
struct WorldOptions {
  int seed = 1;
  int width_px = 640;  ///< the intrinsics of TUM fr3 are scaled to it
  int height_px = 480;
  double fps = 30.0;
  int frames = 0;  ///< 0: as many as one round of the path takes
  PathKind path = PathKind::xyz;

  int people = 0;
  bool busy = false;                  ///< two or three people (or `people`) close to the camera
  MoverKind mover = MoverKind::none;  ///< close to the camera, a third of the view
  bool sit_then_leave = false;        ///< one more person: stands for 3 s, then walks away
  bool come_and_stay = false;         ///< one more person: walks in within 2 s, then stands
  double chairs_moved_m = 0.0;        ///< chairs stand so far to the right of their places
  double frozen_at_s = -1.0;          ///< from 0 on: all that moves stands as at that second

  int rooms = 1;
  bool repeated_posters = false;
  bool identical_desks = false;
  double wall_detail = 1.0;
  double texture_detail = 1.0;

  DepthModel depth = DepthModel::exact;
  double registration_off_px = 0.0;  ///< depth lies so far to the right of colour, 640 px wide
  double depth_late_ms = 0.0;        ///< depth shows the world so long before colour
  double pixel_noise = 1.0;
  double exposure_noise = 0.0;
  LightKind light = LightKind::steady;  ///< else with the camera's automatic exposure and balance
  int light_seed = 1;                   ///< which day it is: levels, colours, where the sun stands
  double light_change_s = 12.0;         ///< how long each light of `changing` lasts
  int covered_from = 0;                 ///< first frame with a covered lens
  int covered_frames = 0;               ///< how many

  MotionSensorOptions sensors;  ///< of motion, besides the camera

  int edge_samples = 4;
  int threads = 1;

  void describe(OptionTable& table);
};

/// TUM fr3 (535.4 539.2 320.1 247.6 at 640 x 480, no distortion) scaled to the options' image size.
/// With the depth limits of the sensor model.
Camera simulated_camera(const WorldOptions& options);

}  // namespace ydd
