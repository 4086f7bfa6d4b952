// SPDX-License-Identifier: Apache-2.0
#include "ydd/messages/ros_writing.h"

#include <gtest/gtest.h>

#include "ydd/messages/ros_pictures.h"

namespace ydd {
namespace {

class RosWriting : public testing::TestWithParam<Wire> {};

TEST_P(RosWriting, PicturesAreReadAgain) {
  ImageMessage image;
  image.stamp = {1'700'000'000'123'456'789};
  image.frame = "optical";
  image.width_px = 2, image.height_px = 1, image.step = 6;
  image.encoding = "bgr8";
  image.data = "abcdef";
  const std::string bytes = write_image(image, GetParam());
  EXPECT_EQ(header_stamp(bytes, GetParam()), image.stamp);
  const auto again = read_image(bytes, GetParam());
  ASSERT_TRUE(again);
  EXPECT_EQ(again->frame, "optical");
  EXPECT_EQ(again->width_px, 2U);
  EXPECT_EQ(again->encoding, "bgr8");
  EXPECT_EQ(again->data, "abcdef");
}

TEST_P(RosWriting, CamerasAreReadAgain) {
  Camera camera{.width_px = 320, .height_px = 240, .fx_px = 260.5, .fy_px = 261.5};
  camera.cx_px = 158.25, camera.cy_px = 119.5;
  camera.k1 = 0.1, camera.k2 = -0.2, camera.p1 = 0.001, camera.p2 = -0.002, camera.k3 = 0.3;
  const std::string bytes = write_camera_info(camera_info_of(camera, {5}, "optical"), GetParam());
  const auto info = read_camera_info(bytes, GetParam());
  ASSERT_TRUE(info);
  const Camera again = camera_of(*info, false).value();
  EXPECT_EQ(again.width_px, 320);
  EXPECT_EQ(again.fx_px, camera.fx_px);
  EXPECT_EQ(again.cy_px, camera.cy_px);
  EXPECT_EQ(again.k3, camera.k3);
  EXPECT_EQ(again.p2, camera.p2);
}

TEST_P(RosWriting, MotionIsReadAgain) {
  ImuMessage imu;
  imu.stamp = {1'700'000'000'000'000'001};
  imu.frame = "imu";
  imu.has_turn = true;
  imu.turn_rad_s = {0.1, -0.2, 0.3};
  imu.acceleration_m_s2 = {1, 2, 9.8};
  const std::string bytes = write_imu(imu, GetParam());
  const auto again = read_imu(bytes, GetParam());
  ASSERT_TRUE(again);
  EXPECT_EQ(again->stamp, imu.stamp);
  EXPECT_TRUE(again->has_turn);
  EXPECT_FALSE(again->has_acceleration);
  EXPECT_EQ(again->turn_rad_s, imu.turn_rad_s);
  EXPECT_EQ(again->acceleration_m_s2, imu.acceleration_m_s2);
  EXPECT_FALSE(read_imu(std::string_view(bytes).substr(0, bytes.size() - 1), GetParam()));

  OdometryMessage odometry;
  odometry.stamp = {5};
  odometry.frame = "odom", odometry.child_frame = "base_footprint";
  odometry.position_m = {1, -2, 3};
  odometry.orientation = {0, 0.6, 0, 0.8};
  const std::string wheels = write_odometry(odometry, GetParam());
  const auto told = read_odometry(wheels, GetParam());
  ASSERT_TRUE(told);
  EXPECT_EQ(told->child_frame, "base_footprint");
  EXPECT_EQ(told->position_m, odometry.position_m);
  EXPECT_EQ(told->orientation, odometry.orientation);
  EXPECT_FALSE(read_odometry(std::string_view(wheels).substr(0, wheels.size() - 1), GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Wires, RosWriting, testing::Values(Wire::ros1, Wire::cdr));

TEST(RosDefinitions, AreThereForWhatIsWritten) {
  EXPECT_TRUE(ros2_definition("sensor_msgs/msg/Image").starts_with("std_msgs/Header header\n"));
  EXPECT_NE(ros2_definition("sensor_msgs/msg/CameraInfo").find("MSG: sensor_msgs/RegionOfInterest"),
            std::string_view::npos);
  EXPECT_TRUE(ros2_definition("sensor_msgs/msg/Unheard").empty());
}

}  // namespace
}  // namespace ydd
