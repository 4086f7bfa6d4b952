// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <tf2_ros/transform_broadcaster.h>

#include "ydd/robot/robot_port.h"

namespace ydd::ros1 {

/// Counters for diagnostics.
struct NodeState {
  std::int64_t received = 0;  ///< pairs that came to the node
  std::int64_t missed = 0;    ///< colour images that it was too busy for, or that had no depth
  std::int64_t failed = 0;    ///< pairs that could not be processed
  double frame_ms = 0;        ///< of the newest frame
  std::string failure;        ///< newest; empty: none
  std::string tracking;       ///< "tracking", "lost", ...; empty: nothing came yet
  std::size_t tracks = 0;
};

/// Everything that is published. Thread: one, but for `publish_cloud` and `publish_grid`, which may
/// have one of their own.
class Publishers {
 public:
  Publishers(ros::NodeHandle& private_node, const PortSettings& settings);

  /// Poses, tf, people and picture of a frame. `robot_frame`: the one that is located.
  void publish(const PortFrame& frame, const RobotPort& port, const ros::Time& stamp,
               const std::string& robot_frame);
  /// Where another node publishes odom to base: what is left of map to odom.
  void publish_map_to_odom(const PortPose& T_map_odom, const ros::Time& stamp);
  /// Path and points, which take longer.
  void publish_slow(const RobotPort& port);
  void publish_diagnostics(const NodeState& state, const RobotPort& port);

  PortAnswer publish_cloud(const RobotPort& port);
  PortAnswer publish_grid(const RobotPort& port);

 private:
  std_msgs::Header header_of(const std::string& frame, const ros::Time& stamp) const;
  void publish_poses(const PortFrame& frame, const ros::Time& stamp,
                     const std::string& robot_frame);

  PortSettings settings_;
  ros::Publisher pose_, odometry_, path_, points_, cloud_, grid_, image_, people_, people_poses_,
      tracks_, diagnostics_;
  tf2_ros::TransformBroadcaster tf_;
};

}  // namespace ydd::ros1
