// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <string>
#include <utility>

#include "ydd/base/id.h"

namespace ydd {

/// Numbers to bytes, little endian on every machine.
class ByteWriter {
 public:
  explicit ByteWriter(std::size_t expected = 64) { bytes_.reserve(expected); }

  template <std::unsigned_integral U>
  void fixed(U value) {
    char bytes[sizeof(U)];
    for (std::size_t i = 0; i < sizeof(U); ++i) {
      bytes[i] = static_cast<char>(static_cast<std::uint8_t>(std::uint64_t{value} >> (8U * i)));
    }
    bytes_.append(bytes, sizeof(U));
  }
  void f32(float value) { fixed(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value) { fixed(std::bit_cast<std::uint64_t>(value)); }
  /// Seven bits a byte, lowest first; the eighth says that more follow.
  void varint(std::uint64_t value) {
    for (; value >= 0x80U; value >>= 7U) bytes_ += static_cast<char>((value & 0x7FU) | 0x80U);
    bytes_ += static_cast<char>(value);
  }
  template <class Tag>
  void id(Id<Tag> id) {
    varint(id.slot);
    varint(id.generation);
  }

  std::string take() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace ydd
