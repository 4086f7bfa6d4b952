// SPDX-License-Identifier: Apache-2.0
#include "ydd/messages/ros_messages.h"

namespace ydd {
namespace {

/// std_msgs/Header: ROS 1 has a counter before the stamp.
Timestamp take_stamp(WireReader& reader, Wire wire) {
  if (wire == Wire::ros1) reader.u32();
  return reader.stamp();
}

/// What the first number of a covariance is where a sensor does not measure that (sensor_msgs/Imu).
constexpr double kNotMeasured = -1;

/// The first of `size` numbers.
double take_covariance(WireReader& reader, int size) {
  const double first = reader.f64();
  for (int i = 1; i < size; ++i) reader.f64();
  return first;
}

}  // namespace

MessageKind message_kind(std::string_view type) {
  for (const std::string_view package : {"sensor_msgs/msg/", "sensor_msgs/"}) {
    if (!type.starts_with(package)) continue;
    const std::string_view name = type.substr(package.size());
    if (name == "Image") return MessageKind::image;
    if (name == "CompressedImage") return MessageKind::compressed_image;
    if (name == "CameraInfo") return MessageKind::camera_info;
    if (name == "Imu") return MessageKind::imu;
  }
  if (type == "nav_msgs/Odometry" || type == "nav_msgs/msg/Odometry") return MessageKind::odometry;
  return MessageKind::other;
}

std::optional<Timestamp> header_stamp(std::string_view start, Wire wire) {
  WireReader reader(start, wire);
  const Timestamp stamp = take_stamp(reader, wire);
  return reader.ok() ? std::optional(stamp) : std::nullopt;
}

std::optional<ImageMessage> read_image(std::string_view message, Wire wire) {
  WireReader reader(message, wire);
  ImageMessage out;
  out.stamp = take_stamp(reader, wire);
  out.frame = reader.text();
  out.height_px = reader.u32();
  out.width_px = reader.u32();
  out.encoding = reader.text();
  out.big_endian = reader.u8() != 0;
  out.step = reader.u32();
  out.data = reader.bytes();
  return reader.ok() ? std::optional(out) : std::nullopt;
}

std::optional<CompressedImageMessage> read_compressed_image(std::string_view message, Wire wire) {
  WireReader reader(message, wire);
  CompressedImageMessage out;
  out.stamp = take_stamp(reader, wire);
  out.frame = reader.text();
  out.format = reader.text();
  out.data = reader.bytes();
  return reader.ok() ? std::optional(out) : std::nullopt;
}

std::optional<ImuMessage> read_imu(std::string_view message, Wire wire) {
  WireReader reader(message, wire);
  ImuMessage out;
  out.stamp = take_stamp(reader, wire);
  out.frame = reader.text();
  for (int i = 0; i < 4; ++i) reader.f64();  // orientation
  take_covariance(reader, 9);
  for (double& value : out.turn_rad_s) value = reader.f64();
  out.has_turn = take_covariance(reader, 9) != kNotMeasured;
  for (double& value : out.acceleration_m_s2) value = reader.f64();
  out.has_acceleration = take_covariance(reader, 9) != kNotMeasured;
  return reader.ok() ? std::optional(out) : std::nullopt;
}

std::optional<OdometryMessage> read_odometry(std::string_view message, Wire wire) {
  WireReader reader(message, wire);
  OdometryMessage out;
  out.stamp = take_stamp(reader, wire);
  out.frame = reader.text();
  out.child_frame = reader.text();
  for (double& value : out.position_m) value = reader.f64();
  for (double& value : out.orientation) value = reader.f64();
  take_covariance(reader, 36);
  for (int i = 0; i < 6; ++i) reader.f64();  // velocity
  take_covariance(reader, 36);
  return reader.ok() ? std::optional(out) : std::nullopt;
}

std::optional<CameraInfoMessage> read_camera_info(std::string_view message, Wire wire) {
  constexpr std::size_t kMostCoefficients = 100;
  WireReader reader(message, wire);
  CameraInfoMessage out;
  out.stamp = take_stamp(reader, wire);
  out.frame = reader.text();
  out.height_px = reader.u32();
  out.width_px = reader.u32();
  out.distortion_model = reader.text();
  out.d = reader.f64_sequence(kMostCoefficients);
  for (double& value : out.k) value = reader.f64();
  for (int i = 0; i < 9; ++i) reader.f64();  // R, of a stereo pair
  for (double& value : out.p) value = reader.f64();
  return reader.ok() ? std::optional(out) : std::nullopt;
}

}  // namespace ydd
