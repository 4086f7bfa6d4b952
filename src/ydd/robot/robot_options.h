// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ydd/base/options.h"
#include "ydd/base/result.h"
#include "ydd/cloud/occupancy_grid.h"
#include "ydd/system/system_options.h"

namespace ydd {

/// Where the floor of the grid is: in the map's x-y plane, where one was seen, or the first with a
/// base_frame and the second without.
enum class GridFloor { automatic, map, seen };
constexpr std::array<std::string_view, 3> choices_of(GridFloor) { return {"auto", "map", "seen"}; }

/// What a node is told by its parameters: the options of the system, and its own.
struct RobotOptions {
  std::string config;    ///< YAML file of options; parameters count more
  std::string camera;    ///< file or preset; empty: what camera_info says
  std::string detector;  ///< file, "none", or empty: the one that comes with the program
  std::string objects;   ///< catalogue; empty: the built-in one
  std::string map_frame = "map", odom_frame = "odom";
  std::string base_frame;       ///< empty: the camera is all there is of the robot
  bool publish_tf = true;       ///< map to odom, ...
  bool publish_odom_tf = true;  ///< ... and odom to base; off: somebody else does
  bool compressed = false;      ///< pictures come as CompressedImage
  bool use_imu = false;         ///< listen to the topic imu, ...
  bool use_odometry = false;    ///< ... to wheel_odometry
  std::string map_file;         ///< to go on with; empty: none. Also what load_map loads
  std::string save_file;        ///< to save to; empty: none
  std::string map_key_file;     ///< with the key of both; empty: as MapKey::find
  bool localization_only = false;
  double max_difference_s = 0.02;  ///< between colour and depth
  double path_hz = 2;              ///< of path and points
  GridFloor grid_floor = GridFloor::automatic;
  GridOptions grid;      ///< of the floor as a grid
  SystemOptions system;  ///< of the system itself

  void describe(OptionTable& table);
};

/// Defaults, beaten by the file that `config` names, beaten by `assignments` ("key=value", with
/// dots in the key where options are nested).
Result<RobotOptions> robot_options(const std::vector<std::string>& assignments);

}  // namespace ydd
