// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "ydd/base/timestamp.h"
#include "ydd/messages/wire_reader.h"

namespace ydd {

/// Puts numbers and texts into a serialised message, in their order: what WireReader takes off.
/// CDR is little endian.
class WireWriter {
 public:
  explicit WireWriter(Wire wire) : wire_(wire) {
    if (wire == Wire::cdr) out_ = std::string("\0\1\0\0", 4);
  }
  const std::string& text() const { return out_; }
  std::string take() && { return std::move(out_); }

  WireWriter& u8(std::uint8_t value) { return number(value, 1); }
  WireWriter& u32(std::uint32_t value) { return number(value, 4); }
  WireWriter& f64(double value) { return number(std::bit_cast<std::uint64_t>(value), 8); }
  /// A sequence of uint8.
  WireWriter& bytes(std::string_view value) {
    u32(static_cast<std::uint32_t>(value.size()));
    out_ += value;
    return *this;
  }
  WireWriter& string(std::string_view value) {
    if (wire_ == Wire::ros1) return bytes(value);
    u32(static_cast<std::uint32_t>(value.size() + 1));
    out_ += value;
    out_ += '\0';
    return *this;
  }
  /// std_msgs/Header; ROS 1 has a counter in it, which nobody sets.
  WireWriter& header(Timestamp stamp, std::string_view frame) {
    if (wire_ == Wire::ros1) u32(0);
    u32(static_cast<std::uint32_t>(stamp.ns / 1'000'000'000));
    u32(static_cast<std::uint32_t>(stamp.ns % 1'000'000'000));
    return string(frame);
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

}  // namespace ydd
