// SPDX-License-Identifier: Apache-2.0
//
// What wheels and an IMU say on the way of a recorded camera, as messages.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <nav_msgs/Odometry.h>
#include <sensor_msgs/Imu.h>
#include <tf2/LinearMath/Quaternion.h>
#include <tf2/LinearMath/Vector3.h>

namespace ydd::ros1_testing {

namespace fs = std::filesystem;

/// Where the camera truly was: x y z qx qy qz qw by stamp.
using TruePoses = std::vector<std::pair<double, std::vector<double>>>;

inline TruePoses true_poses(const fs::path& sequence) {
  TruePoses out;
  std::ifstream in(sequence / "groundtruth.txt");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    double stamp = 0;
    std::vector<double> pose(7);
    words >> stamp;
    for (double& value : pose) words >> value;
    if (words) out.emplace_back(stamp, pose);
  }
  return out;
}

inline const std::vector<double>& truth_at(const TruePoses& poses, const ros::Time& stamp) {
  return std::min_element(poses.begin(), poses.end(),
                          [&](const auto& a, const auto& b) {
                            return std::abs(a.first - stamp.toSec()) <
                                   std::abs(b.first - stamp.toSec());
                          })
      ->second;
}

inline tf2::Vector3 place(const std::vector<double>& pose) { return {pose[0], pose[1], pose[2]}; }
inline tf2::Quaternion turn(const std::vector<double>& pose) {
  return {pose[3], pose[4], pose[5], pose[6]};
}

/// Of wheels that do not slip, at the camera.
inline nav_msgs::Odometry wheels_at(const TruePoses& truth, const std_msgs::Header& header) {
  nav_msgs::Odometry out;
  out.header = header;
  const std::vector<double>& pose = truth_at(truth, header.stamp);
  out.pose.pose.position.x = pose[0];
  out.pose.pose.position.y = pose[1];
  out.pose.pose.position.z = pose[2];
  out.pose.pose.orientation.x = pose[3];
  out.pose.pose.orientation.y = pose[4];
  out.pose.pose.orientation.z = pose[5];
  out.pose.pose.orientation.w = pose[6];
  return out;
}

/// What an IMU beside the camera says between two frames, at 200 Hz: the turn from one to the next,
/// and how the way changes, with gravity (the truth's z points up).
inline std::vector<sensor_msgs::Imu> imu_until(const TruePoses& truth, std::size_t frame) {
  std::vector<sensor_msgs::Imu> out;
  const auto& [from_s, from] = truth[frame - 1];
  const auto& [to_s, to] = truth[frame];
  const double dt_s = to_s - from_s;
  const tf2::Quaternion turned = turn(from).inverse() * turn(to);
  const tf2::Vector3 gyro =
      turned.getAxis() * turned.getAngleShortestPath() / dt_s * (turned.getW() < 0 ? -1.0 : 1.0);
  const tf2::Vector3 before = frame > 1 ? place(truth[frame - 2].second) : place(from);
  const tf2::Vector3 faster =
      frame > 1 ? ((place(to) - place(from)) - (place(from) - before)) / (dt_s * dt_s)
                : tf2::Vector3(0, 0, 0);
  constexpr int kSamples = 7;
  for (int k = 0; k < kSamples; ++k) {
    sensor_msgs::Imu imu;
    imu.header.frame_id = "camera_optical";
    imu.header.stamp = ros::Time(from_s + dt_s * k / kSamples);
    const tf2::Quaternion now = turn(from).slerp(turn(to), static_cast<double>(k) / kSamples);
    const tf2::Vector3 felt = tf2::quatRotate(now.inverse(), faster + tf2::Vector3(0, 0, 9.81));
    imu.angular_velocity.x = gyro.x();
    imu.angular_velocity.y = gyro.y();
    imu.angular_velocity.z = gyro.z();
    imu.linear_acceleration.x = felt.x();
    imu.linear_acceleration.y = felt.y();
    imu.linear_acceleration.z = felt.z();
    out.push_back(imu);
  }
  return out;
}

}  // namespace ydd::ros1_testing
