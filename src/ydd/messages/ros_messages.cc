// SPDX-License-Identifier: Apache-2.0
#include "ydd/messages/ros_messages.h"

namespace ydd {
namespace {

/// std_msgs/Header: ROS 1 has a counter before the stamp.
Timestamp take_stamp(WireReader& reader, Wire wire) {
  if (wire == Wire::ros1) reader.u32();
  return reader.stamp();
}

}  // namespace

MessageKind message_kind(std::string_view type) {
  for (const std::string_view package : {"sensor_msgs/msg/", "sensor_msgs/"}) {
    if (!type.starts_with(package)) continue;
    const std::string_view name = type.substr(package.size());
    if (name == "Image") return MessageKind::image;
    if (name == "CompressedImage") return MessageKind::compressed_image;
    if (name == "CameraInfo") return MessageKind::camera_info;
  }
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
