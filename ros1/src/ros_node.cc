// SPDX-License-Identifier: Apache-2.0
#include "ros_node.h"

#include <utility>

#include <tf2/LinearMath/Transform.h>

#include "to_ros.h"

namespace ydd::ros1 {
namespace {

constexpr std::uint32_t kQueue = 3;  // pictures that wait; older ones are dropped
constexpr double kMounting_s = 10.0;

tf2::Transform rigid(const PortPose& pose) {
  const tf2::Quaternion q(pose.orientation[0], pose.orientation[1], pose.orientation[2],
                          pose.orientation[3]);
  return tf2::Transform(q,
                        tf2::Vector3(pose.position_m[0], pose.position_m[1], pose.position_m[2]));
}

PortPose plain(const tf2::Transform& t) {
  const tf2::Quaternion q = t.getRotation();
  return {{t.getOrigin().x(), t.getOrigin().y(), t.getOrigin().z()}, {q.x(), q.y(), q.z(), q.w()}};
}

}  // namespace

RosNode::RosNode(ros::NodeHandle node, ros::NodeHandle private_node,
                 std::unique_ptr<RobotPort> port)
    : node_(std::move(node)),
      private_node_(std::move(private_node)),
      port_(std::move(port)),
      settings_(port_->settings()),
      publishers_(private_node_, settings_) {
  if (!settings_.base_frame.empty() || !settings_.publish_odom_tf) tf_listener_.emplace(tf_);
  serve("save_map", &RosNode::save_map, nullptr);
  serve("load_map", &RosNode::load_map, nullptr);
  serve("reset", &RosNode::reset, nullptr);
  serve("publish_cloud", &RosNode::publish_cloud, &aside_);
  serve("publish_grid", &RosNode::publish_grid, &aside_);
  services_.push_back(private_node_.advertiseService("set_localization_only",
                                                     &RosNode::set_localization_only, this));
  subscribe();
}

void RosNode::subscribe() {
  pairs_.getPolicy()->setMaxIntervalDuration(ros::Duration(settings_.max_difference_s));
  pairs_.registerCallback(&RosNode::take, this);
  if (settings_.compressed) {
    subscribe_compressed();
  } else {
    pairs_.connectInput(colour_, depth_, info_);
    colour_.subscribe(node_, "colour/image", kQueue);
    depth_.subscribe(node_, "depth/image", kQueue);
  }
  info_.subscribe(node_, "colour/camera_info", kQueue);
  constexpr std::uint32_t kSamples = 1000;  // some seconds of an IMU, while a frame is worked on
  if (settings_.use_imu) imu_ = node_.subscribe("imu", kSamples, &RosNode::sense_turning, this);
  if (settings_.use_odometry) {
    wheels_ = node_.subscribe("wheel_odometry", kSamples, &RosNode::sense_wheels, this);
  }
}

/// Topics as image_transport calls them. They are unpacked when their pair is worked on.
void RosNode::subscribe_compressed() {
  using Passed = message_filters::PassThrough<sensor_msgs::Image>;
  const auto listen = [this](const std::string& topic, const char* transport, Passed& to) {
    const boost::function<void(const sensor_msgs::CompressedImageConstPtr&)> take =
        [&to](const sensor_msgs::CompressedImageConstPtr& packed) {
          const auto image = boost::make_shared<sensor_msgs::Image>();
          image->header = packed->header;
          image->encoding = packed->format;
          image->data = packed->data;
          to.add(image);
        };
    return node_.subscribe<sensor_msgs::CompressedImage>(node_.resolveName(topic) + "/" + transport,
                                                         kQueue, take);
  };
  pairs_.connectInput(passed_colour_, passed_depth_, info_);
  packed_colour_ = listen("colour/image", "compressed", passed_colour_);
  packed_depth_ = listen("depth/image", "compressedDepth", passed_depth_);
}

void RosNode::sense_turning(const sensor_msgs::ImuConstPtr& imu) {
  const auto& w = imu->angular_velocity;
  const auto& a = imu->linear_acceleration;
  port_->add_imu(
      {static_cast<std::int64_t>(imu->header.stamp.toNSec()), {w.x, w.y, w.z}, {a.x, a.y, a.z}});
}

void RosNode::sense_wheels(const nav_msgs::OdometryConstPtr& odometry) {
  const geometry_msgs::Pose& pose = odometry->pose.pose;
  port_->add_odometry(
      static_cast<std::int64_t>(odometry->header.stamp.toNSec()),
      {{pose.position.x, pose.position.y, pose.position.z},
       {pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w}});
}

std::string RosNode::spin() {
  slow_ = node_.createTimer(ros::Duration(1.0 / settings_.path_hz),
                            [this](const ros::TimerEvent&) { publishers_.publish_slow(*port_); });
  diagnose_ = node_.createTimer(ros::Duration(1.0), [this](const ros::TimerEvent&) {
    publishers_.publish_diagnostics(state_, *port_);
  });
  aside_spinner_.start();
  ros::spin();
  aside_spinner_.stop();
  if (!fatal_.empty()) return fatal_;
  const PortAnswer ended = port_->finish();
  return ended.done ? "" : ended.text;
}

void RosNode::end(const std::string& reason) {
  fatal_ = reason;
  ros::requestShutdown();
}

void RosNode::take(const Image& colour, const Image& depth, const Info& info) {
  const ros::WallTime before = ros::WallTime::now();
  ++state_.received;
  count_missed(colour->header.seq);
  if (!port_->started() && !start(*colour, *info)) return;
  const ros::Time& stamp = colour->header.stamp;
  const PortFrame frame =
      port_->push(static_cast<std::int64_t>(stamp.toNSec()), from_ros(*colour), from_ros(*depth));
  if (!frame.failure.empty()) {
    ++state_.failed;
    if (state_.failure != frame.failure) ROS_ERROR("%s", frame.failure.c_str());
    state_.failure = frame.failure;
    return;
  }
  state_.failure.clear();
  state_.tracking = frame.doubt.empty() ? frame.state : frame.state + ": " + frame.doubt;
  state_.tracks = frame.tracks.size();
  publishers_.publish(frame, *port_, stamp, robot_frame_);
  if (settings_.publish_tf && !settings_.publish_odom_tf) correct_odometry(frame, stamp);
  state_.frame_ms = 1e3 * (ros::WallTime::now() - before).toSec();
}

/// A publisher counts its messages; what is missing was dropped on the way or in a queue.
void RosNode::count_missed(std::uint32_t sequence) {
  if (last_sequence_ && sequence > *last_sequence_ + 1) {
    state_.missed += sequence - *last_sequence_ - 1;
  }
  last_sequence_ = sequence;
}

/// Another node's odometry and where the map says that the robot is.
void RosNode::correct_odometry(const PortFrame& frame, const ros::Time& stamp) {
  if (!frame.has_pose) return;
  try {
    const geometry_msgs::TransformStamped odom =
        tf_.lookupTransform(settings_.odom_frame, robot_frame_, stamp, ros::Duration(0.05));
    const tf2::Transform T_odom_robot = rigid(from_ros(odom.transform));
    publishers_.publish_map_to_odom(plain(rigid(frame.T_map_robot) * T_odom_robot.inverse()),
                                    stamp);
  } catch (const tf2::TransformException& e) {
    ROS_WARN_THROTTLE(5, "no %s to %s: %s", settings_.odom_frame.c_str(), robot_frame_.c_str(),
                      e.what());
  }
}

bool RosNode::start(const sensor_msgs::Image& colour, const sensor_msgs::CameraInfo& info) {
  const std::string camera_frame =
      colour.header.frame_id.empty() ? "camera" : colour.header.frame_id;
  const bool robot = !settings_.base_frame.empty();
  robot_frame_ = robot ? settings_.base_frame : camera_frame;
  const std::optional<PortPose> mounted = robot ? mounting(camera_frame) : PortPose();
  if (!mounted) return false;
  const PortAnswer started = port_->start(from_ros(info), *mounted, robot);
  if (!started.done) {
    end(started.text);
    return false;
  }
  ROS_INFO("%s; %s is located", started.text.c_str(), robot_frame_.c_str());
  return true;
}

/// Where the camera is on the robot, from tf. Without it the node ends.
std::optional<PortPose> RosNode::mounting(const std::string& camera_frame) {
  try {
    return from_ros(tf_.lookupTransform(settings_.base_frame, camera_frame, ros::Time(0),
                                        ros::Duration(kMounting_s))
                        .transform);
  } catch (const tf2::TransformException& e) {
    end("tf does not tell where " + camera_frame + " is on " + settings_.base_frame +
        " (parameter base_frame): " + e.what());
    return std::nullopt;
  }
}

PortAnswer RosNode::save_map() {
  std::string file;
  private_node_.getParam("save_file", file);
  return port_->save_map(file);
}

PortAnswer RosNode::load_map() {
  std::string file;
  private_node_.getParam("map_file", file);
  return port_->load_map(file);
}

PortAnswer RosNode::reset() {
  state_.failure.clear();
  return port_->reset();
}

bool RosNode::set_localization_only(std_srvs::SetBool::Request& asked,
                                    std_srvs::SetBool::Response& answer) {
  const PortAnswer done = port_->set_localization_only(asked.data != 0);
  answer.success = done.done ? 1 : 0;
  answer.message = done.text;
  return true;
}

void RosNode::serve(const char* name, PortAnswer (RosNode::*work)(), ros::CallbackQueue* queue) {
  const boost::function<bool(Trigger::Request&, Trigger::Response&)> call =
      [this, work](Trigger::Request&, Trigger::Response& answer) {
        const PortAnswer done = (this->*work)();
        answer.success = done.done ? 1 : 0;
        answer.message = done.text;
        return true;
      };
  auto options =
      ros::AdvertiseServiceOptions::create<Trigger>(name, call, ros::VoidConstPtr(), queue);
  services_.push_back(private_node_.advertiseService(options));
}

}  // namespace ydd::ros1
