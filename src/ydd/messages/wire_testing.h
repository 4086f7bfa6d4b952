// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/timestamp.h"
#include "ydd/messages/wire_reader.h"

namespace ydd {

/// Writes what WireReader reads.
class WireWriter {
 public:
  explicit WireWriter(Wire wire) : wire_(wire) {
    if (wire == Wire::cdr) out_ = std::string("\0\1\0\0", 4);
  }
  const std::string& text() const { return out_; }

  WireWriter& u8(std::uint8_t value) { return number(value, 1); }
  WireWriter& u32(std::uint32_t value) { return number(value, 4); }
  WireWriter& f64(double value) { return number(std::bit_cast<std::uint64_t>(value), 8); }
  WireWriter& bytes(std::string_view value) {
    u32(static_cast<std::uint32_t>(value.size()));
    out_ += value;
    return *this;
  }
  WireWriter& string(std::string value) {
    if (wire_ == Wire::cdr) value += '\0';
    return bytes(value);
  }
  WireWriter& header(Timestamp stamp) {
    if (wire_ == Wire::ros1) u32(7);  // a counter
    u32(static_cast<std::uint32_t>(stamp.ns / 1'000'000'000));
    u32(static_cast<std::uint32_t>(stamp.ns % 1'000'000'000));
    return string("camera_frame");
  }

 private:
  WireWriter& number(std::uint64_t value, std::size_t size) {
    const std::size_t head = wire_ == Wire::cdr ? 4 : 0;
    while (wire_ == Wire::cdr && (out_.size() - head) % size != 0) out_ += '\0';
    for (std::size_t i = 0; i < size; ++i) out_ += static_cast<char>(value >> (8 * i));
    return *this;
  }
  std::string out_;
  Wire wire_;
};

/// sensor_msgs/Image.
inline std::string image_message(Wire wire, Timestamp stamp, std::uint32_t width,
                                 std::uint32_t height, const std::string& encoding,
                                 std::uint32_t step, std::string_view data,
                                 bool big_endian = false) {
  WireWriter w(wire);
  w.header(stamp).u32(height).u32(width).string(encoding).u8(big_endian ? 1 : 0);
  return w.u32(step).bytes(data).text();
}

/// sensor_msgs/CompressedImage.
inline std::string compressed_message(Wire wire, Timestamp stamp, const std::string& format,
                                      std::string_view data) {
  return WireWriter(wire).header(stamp).string(format).bytes(data).text();
}

/// sensor_msgs/CameraInfo without distortion; P is K with a focal length of one more.
inline std::string camera_info_message(Wire wire, Timestamp stamp, std::uint32_t width,
                                       std::uint32_t height, double fx, double fy, double cx,
                                       double cy, const std::vector<double>& d = {},
                                       const std::string& model = "plumb_bob") {
  WireWriter w(wire);
  w.header(stamp).u32(height).u32(width).string(model);
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
