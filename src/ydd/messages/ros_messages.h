// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/timestamp.h"
#include "ydd/messages/wire_reader.h"

/// The messages of sensor_msgs and nav_msgs that a recording is made of, of ROS 1 and 2 alike
/// (https://docs.ros.org/en/api/sensor_msgs/html/). Texts and data point into the message.
namespace ydd {

enum class MessageKind { image, compressed_image, camera_info, imu, odometry, other };

/// Of a type's name: "sensor_msgs/Image" or "sensor_msgs/msg/Image".
MessageKind message_kind(std::string_view type);

/// The stamp of the header that a message of a known kind begins with, from its first
/// `kHeaderStart` bytes or all of it; nothing when it is shorter.
inline constexpr std::size_t kHeaderStart = 16;
std::optional<Timestamp> header_stamp(std::string_view start, Wire wire);

/// sensor_msgs/Image; texts and data point into the message's bytes.
struct ImageMessage {
  Timestamp stamp;
  std::string_view frame;  ///< of coordinates
  std::uint32_t height_px = 0, width_px = 0;
  std::string_view encoding;  ///< "rgb8", "16UC1", ...
  bool big_endian = false;
  std::uint32_t step = 0;  ///< bytes from a row to the next
  std::string_view data;
};

/// sensor_msgs/CompressedImage, likewise.
struct CompressedImageMessage {
  Timestamp stamp;
  std::string_view frame;
  std::string_view format;  ///< "jpeg", "rgb8; jpeg compressed bgr8", "16UC1; compressedDepth png"
  std::string_view data;
};

/// sensor_msgs/CameraInfo.
struct CameraInfoMessage {
  Timestamp stamp;
  std::string frame;
  std::uint32_t height_px = 0, width_px = 0;
  std::string distortion_model;  ///< "plumb_bob", ...
  std::vector<double> d;
  std::array<double, 9> k{};   ///< of the picture as it was taken
  std::array<double, 12> p{};  ///< of the rectified picture
};

/// sensor_msgs/Imu.
struct ImuMessage {
  Timestamp stamp;
  std::string_view frame;
  bool has_turn = false, has_acceleration = false;  ///< a covariance of -1 says that it has not
  std::array<double, 3> turn_rad_s{}, acceleration_m_s2{};
};

/// nav_msgs/Odometry.
struct OdometryMessage {
  Timestamp stamp;
  std::string_view frame, child_frame;
  std::array<double, 3> position_m{};
  std::array<double, 4> orientation{};  ///< x, y, z, w
};

/// Nothing when the bytes are no such message.
std::optional<ImageMessage> read_image(std::string_view message, Wire wire);
std::optional<CompressedImageMessage> read_compressed_image(std::string_view message, Wire wire);
std::optional<CameraInfoMessage> read_camera_info(std::string_view message, Wire wire);
std::optional<ImuMessage> read_imu(std::string_view message, Wire wire);
std::optional<OdometryMessage> read_odometry(std::string_view message, Wire wire);

}  // namespace ydd
