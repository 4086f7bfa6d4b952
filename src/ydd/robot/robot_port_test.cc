// SPDX-License-Identifier: Apache-2.0
#include "ydd/robot/robot_port.h"

#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/temporary_folder_testing.h"
#include "ydd/robot/robot_options.h"
#include "ydd/system/picture_testing.h"

namespace ydd {
namespace {

using testing::HasSubstr;

TEST(RobotOptions, AreTheOptionsOfTheSystemAndOfTheNode) {
  const auto options = robot_options(
      {"dynamics.variant=full", "base_frame=base_link", "tracks.coast_s=2", "detector=none"});
  ASSERT_TRUE(options) << options.error().message;
  EXPECT_EQ(options->system.dynamics.variant, Variant::full);
  EXPECT_EQ(options->base_frame, "base_link");
  EXPECT_EQ(options->system.tracks.coast_s, 2);
  EXPECT_THAT(robot_options({"base_frme=x"}).error().message, HasSubstr("base_frame"));
  EXPECT_THAT(robot_options({"grid_min_height_m=5"}).error().message,
              HasSubstr("grid_max_height_m"));
}

/// Pictures of a wall 2 m away, past which the camera goes to its right.
class Robot : public testing::Test {
 protected:
  std::unique_ptr<RobotPort> open(std::vector<std::string> parameters = {}) {
    parameters.insert(parameters.end(), {"detector=none", "deterministic=true"});
    RobotPort::Opened opened = RobotPort::open(parameters);
    EXPECT_TRUE(opened.port) << opened.failure;
    return std::move(opened.port);
  }
  PortCalibration calibration() const {
    const Camera& c = wall_.camera();
    return {c.width_px,
            c.height_px,
            {c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1},
            {},
            "plumb_bob"};
  }
  static PortFrame push(RobotPort& port, const RgbdFrame& frame) {
    const std::vector<std::uint8_t> grey(frame.grey.data(), frame.grey.data() + 320 * 240);
    std::vector<std::uint8_t> depth;
    for (int i = 0; i < 320 * 240; ++i) {
      const auto mm = static_cast<int>(std::lround(1000 * frame.depth_m.data()[i]));
      depth.push_back(static_cast<std::uint8_t>(mm % 256));
      depth.push_back(static_cast<std::uint8_t>(mm / 256));
    }
    return port.push(frame.stamp.ns, {320, 240, 320, "mono8", false, grey.data(), grey.size()},
                     {320, 240, 640, "16UC1", false, depth.data(), depth.size()});
  }
  double gone_m(int frames) const { return wall_.T_world_camera(frames).translation().x(); }

  const testing_world::Wall wall_{40};
};

TEST_F(Robot, TheCameraIsLocatedInAxesOfRobots) {
  const auto port = open();
  ASSERT_TRUE(port->start(calibration(), {}, false).done);
  PortFrame frame;
  for (int i = 0; i < 20; ++i) {
    frame = push(*port, wall_.frame(i));
    ASSERT_TRUE(frame.failure.empty()) << frame.failure;
    ASSERT_TRUE(frame.has_pose) << i;
  }
  EXPECT_TRUE(frame.tracking);
  EXPECT_NEAR(frame.T_map_robot.position_m[0], 0, 0.01);
  EXPECT_NEAR(frame.T_map_robot.position_m[1], -gone_m(19), 0.01) << "to the right is -y";
  EXPECT_NEAR(frame.T_map_robot.position_m[2], 0, 0.01);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(frame.T_odom_robot.position_m[static_cast<std::size_t>(k)],
                frame.T_map_robot.position_m[static_cast<std::size_t>(k)], 0.03)
        << "but for what the map was corrected by";
  }
  EXPECT_NEAR(frame.velocity[0], gone_m(1) * 30, 0.1) << "x of the camera's own axes";
  const double sigma_m = std::sqrt(frame.covariance[7]);
  EXPECT_GT(sigma_m, 1e-5);
  EXPECT_LT(sigma_m, 0.02);
  EXPECT_EQ(port->path(1000).size(), 20U);
  EXPECT_LE(port->path(5).size(), 6U);
  EXPECT_GT(port->points().size(), 100U);
  EXPECT_GT(port->counts().keyframes, 0U);
  EXPECT_EQ(port->annotated().width_px, 320);
}

TEST_F(Robot, ABaseIsLocatedWhereTheCameraSitsOnIt) {
  const auto port = open();
  // 0.3 m ahead of the base and half a metre up, looking ahead.
  const PortPose mounted{{0.3, 0, 0.5}, {-0.5, 0.5, -0.5, 0.5}};
  ASSERT_TRUE(port->start(calibration(), mounted, true).done);
  const PortFrame first = push(*port, wall_.frame(0));
  ASSERT_TRUE(first.has_pose) << first.failure;
  for (const double m : first.T_map_robot.position_m) EXPECT_NEAR(m, 0, 1e-6);
  EXPECT_NEAR(std::abs(first.T_map_robot.orientation[3]), 1, 1e-6);
  PortFrame frame;
  for (int i = 1; i < 10; ++i) frame = push(*port, wall_.frame(i));
  EXPECT_NEAR(frame.T_map_robot.position_m[1], -gone_m(9), 0.01);
  EXPECT_NEAR(frame.velocity[1], -gone_m(1) * 30, 0.1) << "y of the base";
  for (const PortPoint& p : port->points()) {
    EXPECT_NEAR(p.x, 2.3, 0.05) << "the wall, ahead of the base";
  }
}

TEST_F(Robot, WhileItIsLostOdometryStandsStill) {
  const auto port = open();
  ASSERT_TRUE(port->start(calibration(), {}, false).done);
  PortFrame before;
  for (int i = 0; i < 10; ++i) before = push(*port, wall_.frame(i));
  const PortFrame lost = push(*port, wall_.dark_frame(10));
  EXPECT_FALSE(lost.has_pose);
  EXPECT_FALSE(lost.tracking);
  EXPECT_EQ(lost.T_odom_robot.position_m, before.T_odom_robot.position_m);
  EXPECT_EQ(lost.T_map_odom.position_m, before.T_map_odom.position_m);
  PortFrame found;
  for (int i = 11; i < 16 && !found.has_pose; ++i) found = push(*port, wall_.frame(i));
  ASSERT_TRUE(found.has_pose);
  // What it did meanwhile is a correction of the map: odometry did not jump.
  EXPECT_EQ(found.T_odom_robot.position_m, before.T_odom_robot.position_m);
  EXPECT_LT(found.T_map_odom.position_m[1], -0.005);
}

TEST_F(Robot, WheelsBridgeWhatTheCameraDoesNotSee) {
  const auto port = open();
  const PortPose mounted{{0, 0, 0}, {-0.5, 0.5, -0.5, 0.5}};
  ASSERT_TRUE(port->start(calibration(), mounted, true).done);
  PortFrame frame;
  for (int i = 0; i < 25; ++i) {
    port->add_odometry(wall_.stamp(i).ns, {{0, -gone_m(i), 0}, {0, 0, 0, 1}});
    const bool covered = i > 15;
    frame = push(*port, covered ? wall_.dark_frame(i) : wall_.frame(i));
    ASSERT_TRUE(frame.has_pose) << i << " " << frame.failure;
  }
  EXPECT_NEAR(frame.T_map_robot.position_m[1], -gone_m(24), 0.02);
  EXPECT_GT(frame.covariance[7], 1e-6);
}

TEST_F(Robot, MapsAreSavedLoadedAndForgotten) {
  const TemporaryFolder folder;
  const auto port = open();
  EXPECT_FALSE(port->save_map(folder / "a.map").done) << "there is none yet";
  ASSERT_TRUE(port->start(calibration(), {}, false).done);
  for (int i = 0; i < 10; ++i) push(*port, wall_.frame(i));
  EXPECT_FALSE(port->save_map("").done);
  const PortAnswer saved = port->save_map(folder / "a.map");
  ASSERT_TRUE(saved.done) << saved.text;
  const PortFrame back = push(*port, wall_.frame(5));
  EXPECT_THAT(back.failure, HasSubstr("came after"));
  ASSERT_TRUE(port->reset().done);
  EXPECT_EQ(port->points().size(), 0U);
  EXPECT_NEAR(push(*port, wall_.frame(5)).T_map_robot.position_m[1], 0, 1e-6) << "it begins here";
  EXPECT_THAT(port->load_map(folder / "none.map").text, HasSubstr("none.map"));
  EXPECT_GT(port->points().size(), 0U) << "and the map stays";
  const PortAnswer loaded = port->load_map(folder / "a.map");
  ASSERT_TRUE(loaded.done) << loaded.text;
  ASSERT_TRUE(port->set_localization_only(true).done);
  const PortFrame there = push(*port, wall_.frame(7));
  ASSERT_TRUE(there.has_pose);
  EXPECT_NEAR(there.T_map_robot.position_m[1], -gone_m(7), 0.01) << "in the world of the map";
  EXPECT_TRUE(port->counts().localization_only);
}

TEST_F(Robot, CloudAndGridAreInTheMapsFrame) {
  const auto port = open();
  EXPECT_FALSE(port->cloud().failure.empty());
  ASSERT_TRUE(port->start(calibration(), {{0, 0, 0.5}, {-0.5, 0.5, -0.5, 0.5}}, true).done);
  EXPECT_FALSE(port->grid().failure.empty());
  for (int i = 0; i < 10; ++i) push(*port, wall_.frame(i));
  const PortCloud cloud = port->cloud();
  ASSERT_TRUE(cloud.failure.empty()) << cloud.failure;
  EXPECT_GT(cloud.points.size(), 500U);
  for (const PortPoint& p : cloud.points) ASSERT_NEAR(p.x, 2, 0.05);
  const PortGrid grid = port->grid();
  ASSERT_TRUE(grid.failure.empty()) << grid.failure;
  ASSERT_EQ(grid.cells.size(), static_cast<std::size_t>(grid.columns * grid.rows));
  EXPECT_NEAR(grid.T_map_origin.orientation[3], 1, 1e-9) << "level: the base says where up is";
  bool wall = false;
  for (int i = 0; i < grid.columns * grid.rows; ++i) {
    if (grid.cells[static_cast<std::size_t>(i)] != 100) continue;
    const double x_m = grid.T_map_origin.position_m[0] + (i % grid.columns + 0.5) * 0.05;
    EXPECT_NEAR(x_m, 2, 0.11);
    wall = true;
  }
  EXPECT_TRUE(wall);
}

TEST_F(Robot, WhatCannotBeUsedIsOneLineAndCostsNothingElse) {
  EXPECT_FALSE(RobotPort::open({"nonsense"}).port);
  EXPECT_THAT(RobotPort::open({"no.such=1"}).failure, HasSubstr("no.such"));
  const auto port = open();
  EXPECT_THAT(push(*port, wall_.frame(0)).failure, HasSubstr("not been started"));
  PortCalibration none = calibration();
  none.K = {};
  EXPECT_THAT(port->start(none, {}, false).text, HasSubstr("calibrat"));
  PortCalibration wild = calibration();
  wild.K[2] = 5000;
  EXPECT_THAT(port->start(wild, {}, false).text, HasSubstr("camera_info"));
  EXPECT_FALSE(port->started());
  ASSERT_TRUE(port->start(calibration(), {}, false).done);
  const RgbdFrame frame = wall_.frame(0);
  const auto* colour = reinterpret_cast<const std::uint8_t*>(frame.colour.data());
  const PortImage good{320, 240, 960, "bgr8", false, colour, 960 * 240};
  EXPECT_THAT(port->push(1, good, good).failure, HasSubstr("16UC1"));
  EXPECT_THAT(port->push(1, {320, 240, 960, "bgr8", false, nullptr, 0}, good).failure,
              HasSubstr("damaged"));
  EXPECT_TRUE(push(*port, frame).has_pose);
}

}  // namespace
}  // namespace ydd
