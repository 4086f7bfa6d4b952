// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <message_filters/pass_through.h>
#include <message_filters/subscriber.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/synchronizer.h>
#include <nav_msgs/Odometry.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <ros/spinner.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "publishers.h"

namespace ydd::ros1 {

/// The node: pictures in, what the robot needs out.
///
/// Frames and the services that change the map are handled one after the other by the thread that
/// spins; cloud and grid, which take long, by one of their own, from snapshots of the map. While a
/// frame is worked on newer ones wait in short queues that drop the oldest.
class RosNode {
 public:
  RosNode(ros::NodeHandle node, ros::NodeHandle private_node, std::unique_ptr<RobotPort> port);

  /// Until ROS ends, or an error that nothing can be done about: that is what it gives; else empty.
  std::string spin();

 private:
  using Image = sensor_msgs::ImageConstPtr;
  using Info = sensor_msgs::CameraInfoConstPtr;
  using Policy =
      message_filters::sync_policies::ApproximateTime<sensor_msgs::Image, sensor_msgs::Image,
                                                      sensor_msgs::CameraInfo>;
  using Trigger = std_srvs::Trigger;

  void subscribe();
  void subscribe_compressed();
  void take(const Image& colour, const Image& depth, const Info& info);
  bool start(const sensor_msgs::Image& colour, const sensor_msgs::CameraInfo& info);
  std::optional<PortPose> mounting(const std::string& camera_frame);
  void sense_turning(const sensor_msgs::ImuConstPtr& imu);
  void sense_wheels(const nav_msgs::OdometryConstPtr& odometry);
  void correct_odometry(const PortFrame& frame, const ros::Time& stamp);
  void count_missed(std::uint32_t sequence);
  void end(const std::string& reason);

  PortAnswer save_map();
  PortAnswer load_map();
  PortAnswer reset();
  PortAnswer publish_cloud() { return publishers_.publish_cloud(*port_); }
  PortAnswer publish_grid() { return publishers_.publish_grid(*port_); }
  /// `queue` null: that of the frames.
  void serve(const char* name, PortAnswer (RosNode::*work)(), ros::CallbackQueue* queue);
  bool set_localization_only(std_srvs::SetBool::Request& asked,
                             std_srvs::SetBool::Response& answer);

  ros::NodeHandle node_, private_node_;
  std::unique_ptr<RobotPort> port_;
  PortSettings settings_;
  Publishers publishers_;
  NodeState state_;
  tf2_ros::Buffer tf_;
  std::optional<tf2_ros::TransformListener> tf_listener_;  ///< only where somebody is asked
  message_filters::Subscriber<sensor_msgs::Image> colour_, depth_;
  message_filters::Subscriber<sensor_msgs::CameraInfo> info_;
  message_filters::Synchronizer<Policy> pairs_{Policy(10)};
  ros::Subscriber packed_colour_, packed_depth_;  ///< into the next two, as pictures of no size
  message_filters::PassThrough<sensor_msgs::Image> passed_colour_, passed_depth_;
  ros::Subscriber imu_, wheels_;
  std::vector<ros::ServiceServer> services_;
  ros::CallbackQueue aside_;  ///< of cloud and grid
  ros::AsyncSpinner aside_spinner_{1, &aside_};
  ros::Timer slow_, diagnose_;
  std::string robot_frame_;
  std::optional<std::uint32_t> last_sequence_;
  std::string fatal_;
};

}  // namespace ydd::ros1
