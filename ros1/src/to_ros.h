// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Path.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include "ydd/robot/robot_port.h"

/// Plain values to messages of ROS 1 and back.
namespace ydd::ros1 {

geometry_msgs::Pose to_ros(const PortPose& pose);
geometry_msgs::TransformStamped transform_of(const PortPose& pose, const std_msgs::Header& header,
                                             const std::string& child);
PortPose from_ros(const geometry_msgs::Transform& transform);

/// Valid while the message lives.
/// Of no size: a compressed one, whose format is `encoding`.
PortImage from_ros(const sensor_msgs::Image& image);
PortCalibration from_ros(const sensor_msgs::CameraInfo& info);
sensor_msgs::Image image_of(PortPicture picture, const std_msgs::Header& header);

nav_msgs::Path path_of(const std::vector<PortStampedPose>& poses, const std_msgs::Header& header);
/// With colours or without.
sensor_msgs::PointCloud2 cloud_of(const std::vector<PortPoint>& points, bool colours,
                                  const std_msgs::Header& header);
nav_msgs::OccupancyGrid grid_of(const PortGrid& grid, const std_msgs::Header& header);

/// A cylinder of its size, an arrow to where it is in a second, and its name, for each.
visualization_msgs::MarkerArray markers_of(const std::vector<PortTrack>& tracks,
                                           const std_msgs::Header& header);
/// Where people (alone) are; x axes along the way they go.
geometry_msgs::PoseArray people_of(const std::vector<PortTrack>& tracks,
                                   const std_msgs::Header& header);

}  // namespace ydd::ros1
