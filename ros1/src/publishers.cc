// SPDX-License-Identifier: Apache-2.0
#include "publishers.h"

#include <algorithm>
#include <cstdio>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/this_node.h>
#include <std_msgs/String.h>

#include "to_ros.h"

namespace ydd::ros1 {
namespace {

template <class Value>
diagnostic_msgs::KeyValue told(const char* key, const Value& value) {
  diagnostic_msgs::KeyValue out;
  out.key = key;
  out.value = std::to_string(value);
  return out;
}

}  // namespace

Publishers::Publishers(ros::NodeHandle& node, const PortSettings& settings) : settings_(settings) {
  pose_ = node.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", 10);
  odometry_ = node.advertise<nav_msgs::Odometry>("odometry", 10);
  path_ = node.advertise<nav_msgs::Path>("path", 1, true);
  points_ = node.advertise<sensor_msgs::PointCloud2>("points", 1, true);
  cloud_ = node.advertise<sensor_msgs::PointCloud2>("cloud", 1, true);
  grid_ = node.advertise<nav_msgs::OccupancyGrid>("grid", 1, true);
  image_ = node.advertise<sensor_msgs::Image>("image", 1);
  people_ = node.advertise<visualization_msgs::MarkerArray>("people", 10);
  people_poses_ = node.advertise<geometry_msgs::PoseArray>("people_poses", 10);
  tracks_ = node.advertise<std_msgs::String>("tracks", 10);
  diagnostics_ = ros::NodeHandle().advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);
}

std_msgs::Header Publishers::header_of(const std::string& frame, const ros::Time& stamp) const {
  std_msgs::Header out;
  out.stamp = stamp;
  out.frame_id = frame;
  return out;
}

void Publishers::publish(const PortFrame& frame, const RobotPort& port, const ros::Time& stamp,
                         const std::string& robot_frame) {
  publish_poses(frame, stamp, robot_frame);
  const std_msgs::Header in_map = header_of(settings_.map_frame, stamp);
  people_.publish(markers_of(frame.tracks, in_map));
  people_poses_.publish(people_of(frame.tracks, in_map));
  std_msgs::String line;
  line.data = frame.tracks_json;
  tracks_.publish(line);
  if (image_.getNumSubscribers() > 0) {
    image_.publish(image_of(port.annotated(), header_of(robot_frame, stamp)));
  }
}

void Publishers::publish_poses(const PortFrame& frame, const ros::Time& stamp,
                               const std::string& robot_frame) {
  const std_msgs::Header in_odom = header_of(settings_.odom_frame, stamp);
  if (settings_.publish_tf && settings_.publish_odom_tf) {
    tf_.sendTransform(transform_of(frame.T_odom_robot, in_odom, robot_frame));
    publish_map_to_odom(frame.T_map_odom, stamp);
  }
  if (!frame.has_pose) return;
  geometry_msgs::PoseWithCovarianceStamped pose;
  pose.header = header_of(settings_.map_frame, stamp);
  pose.pose.pose = to_ros(frame.T_map_robot);
  std::copy(frame.covariance.begin(), frame.covariance.end(), pose.pose.covariance.begin());
  pose_.publish(pose);
  nav_msgs::Odometry odometry;
  odometry.header = in_odom;
  odometry.child_frame_id = robot_frame;
  odometry.pose.pose = to_ros(frame.T_odom_robot);
  std::copy(frame.odom_covariance.begin(), frame.odom_covariance.end(),
            odometry.pose.covariance.begin());
  odometry.twist.twist.linear.x = frame.velocity[0];
  odometry.twist.twist.linear.y = frame.velocity[1];
  odometry.twist.twist.linear.z = frame.velocity[2];
  odometry.twist.twist.angular.x = frame.velocity[3];
  odometry.twist.twist.angular.y = frame.velocity[4];
  odometry.twist.twist.angular.z = frame.velocity[5];
  odometry_.publish(odometry);
}

void Publishers::publish_map_to_odom(const PortPose& T_map_odom, const ros::Time& stamp) {
  tf_.sendTransform(
      transform_of(T_map_odom, header_of(settings_.map_frame, stamp), settings_.odom_frame));
}

void Publishers::publish_slow(const RobotPort& port) {
  constexpr std::size_t kMostPoses = 5000;
  const std_msgs::Header in_map = header_of(settings_.map_frame, ros::Time::now());
  if (path_.getNumSubscribers() > 0) path_.publish(path_of(port.path(kMostPoses), in_map));
  if (points_.getNumSubscribers() > 0) points_.publish(cloud_of(port.points(), false, in_map));
}

void Publishers::publish_diagnostics(const NodeState& state, const RobotPort& port) {
  using diagnostic_msgs::DiagnosticStatus;
  DiagnosticStatus status;
  status.name = ros::this_node::getName() + ": tracking";
  status.hardware_id = "camera";
  const bool waits = state.tracking.empty();
  const bool good = state.tracking == "tracking";
  status.level = good ? DiagnosticStatus::OK : DiagnosticStatus::WARN;
  status.message = waits ? "waiting for the first pictures" : state.tracking;
  if (!state.failure.empty()) {
    status.level = DiagnosticStatus::ERROR;
    status.message = state.failure;
  }
  const PortCounts counts = port.counts();
  status.values = {told("pairs received", state.received),
                   told("pairs missed", state.missed),
                   told("pairs failed", state.failed),
                   told("frame [ms]", state.frame_ms),
                   told("people and things", state.tracks),
                   told("keyframes", counts.keyframes),
                   told("points", counts.points),
                   told("loops", counts.loops),
                   told("localization only", counts.localization_only ? 1 : 0)};
  diagnostic_msgs::DiagnosticArray out;
  out.header.stamp = ros::Time::now();
  out.status = {status};
  diagnostics_.publish(out);
}

PortAnswer Publishers::publish_cloud(const RobotPort& port) {
  const PortCloud cloud = port.cloud();
  if (!cloud.failure.empty()) return {false, cloud.failure};
  cloud_.publish(cloud_of(cloud.points, true, header_of(settings_.map_frame, ros::Time::now())));
  return {true, std::to_string(cloud.points.size()) + " points"};
}

PortAnswer Publishers::publish_grid(const RobotPort& port) {
  const PortGrid grid = port.grid();
  if (!grid.failure.empty()) return {false, grid.failure};
  grid_.publish(grid_of(grid, header_of(settings_.map_frame, ros::Time::now())));
  return {true, std::to_string(grid.columns) + " x " + std::to_string(grid.rows) + " cells"};
}

}  // namespace ydd::ros1
