// SPDX-License-Identifier: Apache-2.0
//
// The node as a robot meets it: a real roscore, pictures of the sample played at their pace, every
// topic and service.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <memory>
#include <mutex>
#include <sstream>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/String.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>
#include <visualization_msgs/MarkerArray.h>

#include "motion_testing.h"
#include "ros_testing.h"

namespace ydd::ros1_testing {
namespace {

const fs::path kSample = fs::path(YDD_SOURCE_DIR) / "samples/office_crowd";
const std::string kDetector = (fs::path(YDD_SOURCE_DIR) / "configs/detector/ydd.yaml").string();

class Ros1 : public testing::Test {
 protected:
  void SetUp() override {
    if (!on_path("roscore")) {
      GTEST_SKIP() << "skipped: roscore is not installed (tools/install-deps --ros)";
    }
    static Core core;
    core_ = &core;
    spinner_ = std::make_unique<ros::AsyncSpinner>(2);
    spinner_->start();
  }
  void TearDown() override {
    node_.reset();
    if (spinner_) spinner_->stop();
  }

  /// `parameters`: "_name:=value".
  void start_node(std::vector<std::string> parameters) {
    ros::param::del("/ydd_slam");  // of the test before
    parameters.insert(parameters.begin(), {YDD_NODE, "__name:=ydd_slam"});
    node_ = std::make_unique<Program>(std::move(parameters), *core_ / "node.txt");
  }
  static std::pair<bool, std::string> trigger(const std::string& service) {
    std_srvs::Trigger call;
    if (!ros::service::waitForService(service, ros::Duration(10)) ||
        !ros::service::call(service, call)) {
      return {false, service + " does not answer"};
    }
    return {call.response.success != 0, call.response.message};
  }

  Core* core_ = nullptr;
  std::unique_ptr<ros::AsyncSpinner> spinner_;
  std::unique_ptr<Program> node_;
};

/// Root mean square of the trajectory error, by the project's own tool.
double ate_m(const std::string& trajectory) {
  Folder folder;
  Program eval({YDD_BINARY, "eval", (kSample / "groundtruth.txt").string(), trajectory, "--json"},
               folder / "eval.json");
  if (eval.wait(60) != 0) return -1;
  const std::string text = eval.output();
  const auto ate = text.find("\"absolute_translational_error\"");
  const auto rmse = text.find("\"rmse\":", ate);
  return rmse == std::string::npos ? -1 : std::strtod(text.c_str() + rmse + 7, nullptr);
}

std::string tum_line(const ros::Time& stamp, const geometry_msgs::Pose& pose) {
  std::ostringstream out;
  out.precision(9);
  out << std::fixed << stamp.sec << '.' << std::setw(9) << std::setfill('0') << stamp.nsec << ' '
      << pose.position.x << ' ' << pose.position.y << ' ' << pose.position.z << ' '
      << pose.orientation.x << ' ' << pose.orientation.y << ' ' << pose.orientation.z << ' '
      << pose.orientation.w << '\n';
  return out.str();
}

double length(double x, double y, double z) { return std::hypot(x, y, z); }

TEST_F(Ros1, EveryTopicTellsWhatThereIsAndThePathIsAsGoodAsOffline) {
  start_node({"_detector:=" + kDetector, "_save_file:=" + (*core_ / "saved.map")});
  Heard<geometry_msgs::PoseWithCovarianceStamped> poses("/ydd_slam/pose");
  Heard<nav_msgs::Odometry> odometry("/ydd_slam/odometry");
  Heard<nav_msgs::Path> path("/ydd_slam/path");
  Heard<sensor_msgs::PointCloud2> points("/ydd_slam/points"), cloud("/ydd_slam/cloud");
  Heard<nav_msgs::OccupancyGrid> grid("/ydd_slam/grid");
  Heard<sensor_msgs::Image> image("/ydd_slam/image");
  Heard<visualization_msgs::MarkerArray> people("/ydd_slam/people");
  Heard<geometry_msgs::PoseArray> people_poses("/ydd_slam/people_poses");
  Heard<std_msgs::String> tracks("/ydd_slam/tracks");
  Heard<diagnostic_msgs::DiagnosticArray> diagnostics("/diagnostics");
  tf2_ros::Buffer tf(ros::Duration(60));
  const tf2_ros::TransformListener tf_listener(tf);
  CameraDriver camera;
  const Recording recording(kSample);
  ASSERT_TRUE(camera.somebody_listens()) << node_->output();
  ASSERT_TRUE(poses.connected() && odometry.connected() && path.connected() && people.connected() &&
              people_poses.connected() && tracks.connected() && image.connected());
  // The network is loaded with the first pictures.
  camera.play(recording, 0, 1);
  ASSERT_TRUE(wait_for([&] { return poses.count() > 0; }, 30)) << node_->output();
  camera.play(recording, 1, recording.size());
  ASSERT_TRUE(wait_for([&] { return path.count() > 0 && path.last().poses.size() > 30; }, 15));

  // --- where the camera is ---
  const auto all = poses.all();
  // A machine that is busy with other things drops some of the 90.
  ASSERT_GT(all.size(), 30U);
  for (const auto& pose : all) {
    EXPECT_EQ(pose.header.frame_id, "map");
    for (int k = 0; k < 6; ++k) {
      const double sigma = std::sqrt(pose.pose.covariance[static_cast<std::size_t>(7 * k)]);
      EXPECT_GT(sigma, 1e-6);
      EXPECT_LT(sigma, 0.05);
    }
  }
  const auto& first = all.front().pose.pose;
  EXPECT_LT(length(first.position.x, first.position.y, first.position.z), 0.01);
  for (const auto& o : odometry.all()) {
    EXPECT_EQ(o.header.frame_id, "odom");
    EXPECT_EQ(o.child_frame_id, "camera_optical");
    EXPECT_LT(length(o.twist.twist.linear.x, o.twist.twist.linear.y, o.twist.twist.linear.z), 3);
  }
  const auto& last = all.back();
  const auto T = tf.lookupTransform("map", "camera_optical", last.header.stamp, ros::Duration(5));
  EXPECT_LT(length(T.transform.translation.x - last.pose.pose.position.x,
                   T.transform.translation.y - last.pose.pose.position.y,
                   T.transform.translation.z - last.pose.pose.position.z),
            1e-6);

  // --- how well: as the offline run on what came in time ---
  {
    std::ofstream file(*core_ / "node.tum");
    for (const auto& pose : path.last().poses) file << tum_line(pose.header.stamp, pose.pose);
  }
  Program offline({YDD_BINARY, "run", kSample.string(), "--detector", kDetector, "--detect",
                   "asynchronous", "--realtime", "--out", *core_ / "offline", "--quiet"},
                  *core_ / "offline.txt");
  ASSERT_EQ(offline.wait(120), 0) << offline.output();
  const double node_m = ate_m(*core_ / "node.tum");
  const double offline_m = ate_m(*core_ / "offline/trajectory.tum");
  std::printf("ATE of the node's path %.4f m (%zu poses), of a run in real time %.4f m\n", node_m,
              path.last().poses.size(), offline_m);
  ASSERT_GT(node_m, 0);
  EXPECT_LT(node_m, 2 * offline_m + 0.003);

  // --- who is there ---
  EXPECT_GT(people.count(), 30U);
  std::size_t with_people = 0;
  for (const auto& one : people_poses.all()) {
    EXPECT_EQ(one.header.frame_id, "map");
    EXPECT_LE(one.poses.size(), 6U);
    with_people += one.poses.empty() ? 0 : 1;
    for (const auto& pose : one.poses) {
      EXPECT_GT(pose.position.x, 0.2) << "before the camera";
      EXPECT_LT(pose.position.x, 6);
    }
  }
  EXPECT_GT(with_people, 20U);
  EXPECT_NE(tracks.last().data.find("\"class\":\"person\""), std::string::npos);

  // --- what the map looks like ---
  EXPECT_TRUE(wait_for([&] { return points.count() > 0 && points.last().width > 300; }, 5));
  const auto made = trigger("/ydd_slam/publish_cloud");
  ASSERT_TRUE(made.first) << made.second;
  ASSERT_TRUE(wait_for([&] { return cloud.count() > 0; }, 10));
  EXPECT_GT(cloud.last().width, 2000U);
  EXPECT_EQ(cloud.last().fields.size(), 4U);
  EXPECT_EQ(cloud.last().data.size(), std::size_t{cloud.last().width} * 16);
  const auto floor = trigger("/ydd_slam/publish_grid");
  ASSERT_TRUE(floor.first) << floor.second;
  ASSERT_TRUE(wait_for([&] { return grid.count() > 0; }, 10));
  const nav_msgs::OccupancyGrid g = grid.last();
  ASSERT_EQ(g.data.size(), std::size_t{g.info.width} * g.info.height);
  EXPECT_GT(std::count(g.data.begin(), g.data.end(), 100), 100);
  EXPECT_GT(std::count(g.data.begin(), g.data.end(), 0), 100);
  EXPECT_LT(g.info.origin.position.z, -1) << "the floor is below the camera";

  // --- the rest ---
  ASSERT_GT(image.count(), 10U);
  EXPECT_EQ(image.last().width, 640U);
  EXPECT_EQ(image.last().encoding, "bgr8");
  EXPECT_EQ(image.last().data.size(), std::size_t{640 * 480 * 3});
  ASSERT_GT(diagnostics.count(), 1U);
  const auto status = diagnostics.last().status.at(0);
  EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::OK) << status.message;
  EXPECT_EQ(status.message, "tracking");

  // --- services ---
  const auto saved = trigger("/ydd_slam/save_map");
  ASSERT_TRUE(saved.first) << saved.second;
  Program info({YDD_BINARY, "map", "info", *core_ / "saved.map"}, *core_ / "info.txt");
  EXPECT_EQ(info.wait(20), 0) << info.output();
  EXPECT_NE(info.output().find("keyframes"), std::string::npos);
  EXPECT_FALSE(trigger("/ydd_slam/load_map").first) << "no file is named";
  ros::param::set("/ydd_slam/map_file", *core_ / "saved.map");
  const auto loaded = trigger("/ydd_slam/load_map");
  EXPECT_TRUE(loaded.first) << loaded.second;
  std_srvs::SetBool keep;
  keep.request.data = 1;
  EXPECT_TRUE(ros::service::call("/ydd_slam/set_localization_only", keep));
  const std::size_t before = poses.count();
  camera.play(recording, 0, 30);  // stamps go on from nothing in the map that was loaded
  EXPECT_TRUE(wait_for([&] { return poses.count() > before + 10; }, 10)) << node_->output();
  EXPECT_TRUE(trigger("/ydd_slam/reset").first);
  EXPECT_EQ(node_->end(), 0) << node_->output();
}

TEST_F(Ros1, LocatesTheBaseOfARobot) {
  geometry_msgs::TransformStamped mounted;  // half a metre up, looking ahead and a little down
  mounted.header.frame_id = "base_link";
  mounted.child_frame_id = "camera_optical";
  mounted.transform.translation.x = 0.2;
  mounted.transform.translation.z = 0.5;
  mounted.transform.rotation.x = -0.5;
  mounted.transform.rotation.y = 0.5;
  mounted.transform.rotation.z = -0.5;
  mounted.transform.rotation.w = 0.5;
  tf2_ros::StaticTransformBroadcaster tf;
  tf.sendTransform(mounted);
  start_node({"_detector:=none", "_base_frame:=base_link"});
  Heard<geometry_msgs::PoseWithCovarianceStamped> poses("/ydd_slam/pose");
  Heard<nav_msgs::Odometry> odometry("/ydd_slam/odometry");
  Heard<sensor_msgs::PointCloud2> points("/ydd_slam/points");
  CameraDriver camera;
  const Recording recording(kSample);
  ASSERT_TRUE(camera.somebody_listens() && poses.connected()) << node_->output();
  camera.play(recording, 0, 1);
  ASSERT_TRUE(wait_for([&] { return poses.count() > 0; }, 30)) << node_->output();
  camera.play(recording, 1, 30);
  ASSERT_TRUE(wait_for([&] { return poses.count() > 15; }, 10));
  const auto first = poses.all().front().pose.pose;
  EXPECT_LT(length(first.position.x, first.position.y, first.position.z), 0.01)
      << "the map begins below the robot";
  EXPECT_NEAR(std::abs(first.orientation.w), 1, 1e-3);
  EXPECT_EQ(odometry.last().child_frame_id, "base_link");
}

TEST_F(Ros1, TakesCompressedPictures) {
  start_node({"_detector:=none", "_compressed:=true"});
  Heard<geometry_msgs::PoseWithCovarianceStamped> poses("/ydd_slam/pose");
  PackedDriver camera;
  const Recording recording(kSample);
  ASSERT_TRUE(camera.somebody_listens() && poses.connected()) << node_->output();
  std::size_t played = 0;
  for (; played < 12; ++played) {  // one after the other: none is dropped
    camera.publish(recording, played);
    const std::size_t wanted = played + 1;
    ASSERT_TRUE(wait_for([&] { return poses.count() >= wanted; }, 30)) << node_->output();
  }
  const auto& last = poses.last().pose.pose.position;
  EXPECT_GT(length(last.x, last.y, last.z), 0.001) << "it has moved";
}

double variance(const geometry_msgs::PoseWithCovarianceStamped& pose) {
  return pose.pose.covariance[0] + pose.pose.covariance[7] + pose.pose.covariance[14];
}

TEST_F(Ros1, GoesOnByWheelsAndImuWhileTheLensIsCovered) {
  start_node({"_detector:=none", "_use_odometry:=true", "_use_imu:=true",
              "_mapping/inertial/enabled:=true"});
  Heard<geometry_msgs::PoseWithCovarianceStamped> poses("/ydd_slam/pose");
  Heard<diagnostic_msgs::DiagnosticArray> diagnostics("/diagnostics");
  CameraDriver camera;
  ros::NodeHandle node;
  const ros::Publisher wheels = node.advertise<nav_msgs::Odometry>("wheel_odometry", 1000);
  const ros::Publisher imu = node.advertise<sensor_msgs::Imu>("imu", 1000);
  const Recording recording(kSample);
  ASSERT_TRUE(camera.somebody_listens() && poses.connected()) << node_->output();
  ASSERT_TRUE(
      wait_for([&] { return wheels.getNumSubscribers() > 0 && imu.getNumSubscribers() > 0; }, 30));
  const auto says = [&](const std::string& state) {
    return wait_for(
        [&] {  // with its reason behind it
          return diagnostics.count() > 0 &&
                 diagnostics.last().status.at(0).message.rfind(state, 0) == 0;
        },
        10);
  };
  const auto truth = true_poses(kSample);
  constexpr std::size_t kCovered = 20, kUncovered = 35, kEnd = 45;
  for (std::size_t i = 0; i < kEnd; ++i) {
    auto colour = recording.colour(i);
    auto depth = recording.depth(i);
    if (i > 0) {
      for (const sensor_msgs::Imu& sample : imu_until(truth, i)) imu.publish(sample);
    }
    wheels.publish(wheels_at(truth, colour.header));
    if (i >= kCovered && i < kUncovered) {
      std::fill(colour.data.begin(), colour.data.end(), std::uint8_t{0});
      std::fill(depth.data.begin(), depth.data.end(), std::uint8_t{0});
    }
    // The others are heard before the pictures: another connection.
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    camera.publish(colour, depth, recording.info(i));
    ASSERT_TRUE(wait_for([&] { return poses.count() > i; }, 30)) << i << node_->output();
    if (i == kCovered + 2) {
      EXPECT_TRUE(says("coasting")) << node_->output();
    }
  }
  EXPECT_TRUE(says("tracking")) << node_->output();

  const auto all = poses.all();
  ASSERT_EQ(all.size(), kEnd) << "every frame has a pose";
  for (std::size_t i = kCovered; i < kUncovered; ++i) {
    EXPECT_GT(variance(all[i]), variance(all[i - 1])) << "frame " << i << ": it knows less";
  }
  EXPECT_LT(variance(all.back()), variance(all[kUncovered - 1])) << "and sees again";
  const auto off_m = [&](std::size_t from, std::size_t to) {
    const tf2::Vector3 truly = place(truth_at(truth, all[to].header.stamp)) -
                               place(truth_at(truth, all[from].header.stamp));
    const auto& a = all[from].pose.pose.position;
    const auto& b = all[to].pose.pose.position;
    return std::abs(truly.length() - length(b.x - a.x, b.y - a.y, b.z - a.z));
  };
  EXPECT_LT(off_m(kCovered - 1, kUncovered - 1), 0.02);
  EXPECT_LT(off_m(kCovered - 1, kEnd - 1), 0.02);
}

TEST_F(Ros1, CorrectsTheOdometryOfAnotherNode) {
  geometry_msgs::TransformStamped still;  // its wheels do not turn
  still.header.frame_id = "odom";
  still.child_frame_id = "camera_optical";
  still.transform.rotation.w = 1;
  tf2_ros::StaticTransformBroadcaster wheels;
  wheels.sendTransform(still);
  start_node({"_detector:=none", "_publish_odom_tf:=false"});
  Heard<geometry_msgs::PoseWithCovarianceStamped> poses("/ydd_slam/pose");
  tf2_ros::Buffer tf(ros::Duration(60));
  const tf2_ros::TransformListener tf_listener(tf);
  CameraDriver camera;
  const Recording recording(kSample);
  ASSERT_TRUE(camera.somebody_listens() && poses.connected()) << node_->output();
  camera.play(recording, 0, 1);
  ASSERT_TRUE(wait_for([&] { return poses.count() > 0; }, 30)) << node_->output();
  camera.play(recording, 1, 40);
  ASSERT_TRUE(wait_for([&] { return poses.count() > 15; }, 10));
  const auto last = poses.last();
  const auto T = tf.lookupTransform("map", "odom", last.header.stamp, ros::Duration(5));
  EXPECT_LT(length(T.transform.translation.x - last.pose.pose.position.x,
                   T.transform.translation.y - last.pose.pose.position.y,
                   T.transform.translation.z - last.pose.pose.position.z),
            1e-6);
}

TEST_F(Ros1, IsLaunched) {
  ros::param::del("/ydd_slam");
  ::setenv("ROS_PACKAGE_PATH", fs::path(YDD_NODE).parent_path().parent_path().c_str(), 1);
  Heard<geometry_msgs::PoseWithCovarianceStamped> poses("/ydd_slam/pose");
  node_ = std::make_unique<Program>(
      std::vector<std::string>{"roslaunch", "ydd_slam", "ydd_slam.launch", "colour:=/colour/image",
                               "camera_info:=/colour/camera_info", "depth:=/depth/image",
                               "detector:=none"},
      *core_ / "launch.txt");
  CameraDriver camera;
  const Recording recording(kSample);
  ASSERT_TRUE(camera.somebody_listens() && poses.connected()) << node_->output();
  camera.play(recording, 0, 10);
  EXPECT_TRUE(wait_for([&] { return poses.count() > 0; }, 30)) << node_->output();
}

TEST_F(Ros1, WhatCannotBeReadIsOneLineAndTheNodeGoesOn) {
  start_node({"_detector:=none"});
  Heard<diagnostic_msgs::DiagnosticArray> diagnostics("/diagnostics");
  Heard<geometry_msgs::PoseWithCovarianceStamped> poses("/ydd_slam/pose");
  CameraDriver camera;
  const Recording recording(kSample);
  ASSERT_TRUE(camera.somebody_listens() && poses.connected()) << node_->output();
  camera.play(recording, 0, 1);
  ASSERT_TRUE(wait_for([&] { return poses.count() > 0; }, 30)) << node_->output();
  const auto says = [&](const std::string& part) {
    return wait_for(
        [&] {
          return diagnostics.count() > 0 &&
                 diagnostics.last().status.at(0).message.find(part) != std::string::npos;
        },
        10);
  };
  auto bayer = recording.colour(1);
  bayer.encoding = "bayer_rggb8";
  camera.publish(bayer, recording.depth(1), recording.info(1));
  EXPECT_TRUE(says("bayer_rggb8")) << node_->output();
  auto small = recording.depth(2);
  small.height /= 2;
  camera.publish(recording.colour(2), small, recording.info(2));
  EXPECT_TRUE(says("registered")) << node_->output();
  auto cut = recording.depth(3);
  cut.data.resize(1000);
  camera.publish(recording.colour(3), cut, recording.info(3));
  EXPECT_TRUE(says("damaged")) << node_->output();
  const std::size_t before = poses.count();
  camera.play(recording, 4, 12);
  EXPECT_TRUE(wait_for([&] { return poses.count() > before; }, 10)) << "and on it goes";
}

TEST_F(Ros1, WrongParametersEndItInOneLine) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"_tracks/coast_s:=-3", "tracks.coast_s"},
      {"_no_such_option:=1", "no_such_option"},
      {"_config:=/no/such.yaml", "/no/such.yaml"},
      {"_grid_min_height_m:=3.0", "grid_min_height_m"}};
  for (const auto& [parameter, named] : cases) {
    start_node({parameter});
    EXPECT_EQ(node_->wait(20), 1) << parameter;
    const std::string output = node_->output();
    EXPECT_NE(output.find("error: "), std::string::npos) << output;
    EXPECT_NE(output.find(named), std::string::npos) << output;
    node_.reset();
  }
}

TEST_F(Ros1, ACameraThatWasNeverCalibratedEndsIt) {
  start_node({"_detector:=none"});
  CameraDriver camera;
  const Recording recording(kSample);
  ASSERT_TRUE(camera.somebody_listens()) << node_->output();
  auto info = recording.info(0);
  info.K.assign(0);
  camera.publish(recording.colour(0), recording.depth(0), info);
  EXPECT_EQ(node_->wait(20), 1);
  EXPECT_NE(node_->output().find("calibrat"), std::string::npos) << node_->output();
}

}  // namespace
}  // namespace ydd::ros1_testing
