// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "ydd/base/timestamp.h"

namespace ydd {

/// How a message became bytes.
enum class Wire {
  ros1,  ///< ROS 1: little endian, packed
  cdr,   ///< ROS 2: CDR (OMG DDSI-RTPS 10.2), aligned; its first four bytes tell the byte order
};

/// Takes numbers and texts off a serialised message, in their order. What it gives points into the
/// message. After something that is not there `ok()` is false, and all that follows is 0 or empty:
/// a caller may read everything and ask once.
class WireReader {
 public:
  WireReader(std::string_view message, Wire wire);

  bool ok() const { return ok_; }
  std::size_t left() const { return rest_.size(); }

  std::uint8_t u8();
  std::uint32_t u32();
  double f64();
  /// Without the zero at its end.
  std::string_view text();
  /// A sequence of uint8.
  std::string_view bytes();
  /// A sequence of float64 of at most `most`.
  std::vector<double> f64_sequence(std::size_t most);
  /// Seconds and nanoseconds.
  Timestamp stamp();

 private:
  std::string_view take(std::size_t size, std::size_t alignment);
  std::uint64_t number(std::size_t size);

  std::string_view rest_;
  std::size_t taken_ = 0;  ///< of what CDR counts alignment from
  Wire wire_;
  bool big_endian_ = false;
  bool ok_ = true;
};

}  // namespace ydd
