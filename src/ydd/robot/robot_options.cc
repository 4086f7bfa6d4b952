// SPDX-License-Identifier: Apache-2.0
#include "ydd/robot/robot_options.h"

namespace ydd {

void RobotOptions::describe(OptionTable& t) {
  t.add("config", config, {}, "YAML file with options; parameters count more");
  t.add("camera", camera, {}, "camera file or preset; empty: what camera_info says");
  t.add("detector", detector, {},
        "detector file; none; empty: the one that comes with the program");
  t.add("objects", objects, {}, "object catalogue; empty: the built-in one");
  t.add("map_frame", map_frame, {}, "frame of the map");
  t.add("odom_frame", odom_frame, {}, "frame that goes on smoothly");
  t.add("base_frame", base_frame, {}, "frame of the robot; empty: that of the camera");
  t.add("publish_tf", publish_tf, "publish map to odom");
  t.add("publish_odom_tf", publish_odom_tf, "publish odom to base; off: another node does");
  t.add("compressed", compressed, "listen to compressed pictures instead of raw ones");
  t.add("use_imu", use_imu, "let the IMU of the topic imu predict the motion");
  t.add("use_odometry", use_odometry, "the same for the wheels of the topic wheel_odometry");
  t.add("map_file", map_file, {}, "map to go on with, and what load_map loads");
  t.add("save_file", save_file, {}, "map file that is saved by itself and by save_map");
  t.add("map_key_file", map_key_file, {},
        "file with the key of both; empty: what YDD_MAP_KEY_FILE names, else they are plain");
  t.add("localization_only", localization_only, "use the map without changing it");
  t.add("max_difference_s", max_difference_s, {0.0, 1.0}, "s",
        "largest time between a colour and a depth image");
  t.add("path_hz", path_hz, {0.01, 30.0}, "Hz", "how often path and points are published");
  t.add("grid_floor", grid_floor, "floor of the grid: the map's plane, or where one is seen");
  t.add("grid_resolution_m", grid.resolution_m, {0.005, 10.0}, "m", "edge of a cell");
  t.add("grid_min_height_m", grid.min_height_m, {0.01, 10.0}, "m", "what is lower is no obstacle");
  t.add("grid_max_height_m", grid.max_height_m, {0.02, 20.0}, "m", "what is higher is no obstacle");
  t.add("cloud_voxel_m", grid.cloud.voxel_m, {0.001, 10.0}, "m", "edge of the cloud's cubes");
  t.add("cloud_max_depth_m", grid.cloud.max_depth_m, {0.1, 100.0}, "m",
        "farther readings are left out of cloud and grid");
  system.describe(t);
}

Result<RobotOptions> robot_options(const std::vector<std::string>& assignments) {
  RobotOptions options;
  OptionTable table;
  options.describe(table);
  const auto apply = [&]() -> Result<void> {
    for (const std::string& assignment : assignments) {
      if (auto r = table.set_assignment(assignment, "parameter"); !r) return r;
    }
    return {};
  };
  if (auto r = apply(); !r) return r.error();
  if (!options.config.empty()) {  // between the defaults and the parameters
    if (auto r = table.load_yaml(options.config); !r) return r.error();
    if (auto r = apply(); !r) return r.error();
  }
  if (auto r = check(options.system.reckoning); !r) return r.error();
  if (options.grid.min_height_m >= options.grid.max_height_m) {
    return Error{"parameter: grid_min_height_m must be less than grid_max_height_m"};
  }
  return options;
}

}  // namespace ydd
