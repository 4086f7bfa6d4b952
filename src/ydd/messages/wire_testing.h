// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/timestamp.h"
#include "ydd/messages/wire_writer.h"

namespace ydd {

/// sensor_msgs/Image.
inline std::string image_message(Wire wire, Timestamp stamp, std::uint32_t width,
                                 std::uint32_t height, const std::string& encoding,
                                 std::uint32_t step, std::string_view data,
                                 bool big_endian = false) {
  WireWriter w(wire);
  w.header(stamp, "camera_frame").u32(height).u32(width).string(encoding).u8(big_endian ? 1 : 0);
  return w.u32(step).bytes(data).text();
}

/// sensor_msgs/CompressedImage.
inline std::string compressed_message(Wire wire, Timestamp stamp, const std::string& format,
                                      std::string_view data) {
  return WireWriter(wire).header(stamp, "camera_frame").string(format).bytes(data).text();
}

/// sensor_msgs/CameraInfo without distortion; P is K with a focal length of one more.
inline std::string camera_info_message(Wire wire, Timestamp stamp, std::uint32_t width,
                                       std::uint32_t height, double fx, double fy, double cx,
                                       double cy, const std::vector<double>& d = {},
                                       const std::string& model = "plumb_bob") {
  WireWriter w(wire);
  w.header(stamp, "camera_frame").u32(height).u32(width).string(model);
  w.u32(static_cast<std::uint32_t>(d.size()));
  for (const double value : d) w.f64(value);
  for (const double value : {fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0}) w.f64(value);
  for (const double value : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) w.f64(value);
  for (const double value : {fx + 1, 0.0, cx, 0.0, 0.0, fy + 1, cy, 0.0, 0.0, 0.0, 1.0, 0.0}) {
    w.f64(value);
  }
  return w.u32(0).u32(0).u32(0).u32(0).u32(0).u32(0).u8(0).text();  // binning and region
}

}  // namespace ydd
