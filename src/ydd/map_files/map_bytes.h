// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

#include "ydd/base/byte_writer.h"
#include "ydd/base/checksum.h"

/// How numbers lie in the blobs of a map file. Inside the room only.
namespace ydd::map_format {

/// Why a map file cannot be used, without its name. Does not leave the room: whatever opens a file
/// turns it into a Result.
class Fault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Why a sound file cannot be used as it was asked for: the wrong key, another program's.
class Refused : public Fault {
 public:
  using Fault::Fault;
};

/// Bytes to numbers. @throws Fault where the bytes end too early or a number is too large.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <std::unsigned_integral U>
  U fixed() {
    const std::string_view bytes = take(sizeof(U));
    if constexpr (std::endian::native == std::endian::little) {  // one load instead of eight
      U value = 0;
      std::memcpy(&value, bytes.data(), sizeof(U));
      return value;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(U); ++i) {
      value |= static_cast<std::uint64_t>(static_cast<std::uint8_t>(bytes[i])) << (8U * i);
    }
    return static_cast<U>(value);
  }
  float f32() { return std::bit_cast<float>(fixed<std::uint32_t>()); }
  double f64() { return std::bit_cast<double>(fixed<std::uint64_t>()); }
  std::uint64_t varint(std::uint64_t largest) {
    if (!rest_.empty() && static_cast<std::uint8_t>(rest_.front()) < 0x80U) {  // most are small
      const auto value = static_cast<std::uint8_t>(rest_.front());
      rest_.remove_prefix(1);
      if (value > largest) throw Fault("a number that is too large");
      return value;
    }
    std::uint64_t value = 0;
    for (unsigned shift = 0;; shift += 7U) {
      const auto byte = static_cast<std::uint8_t>(take(1).front());
      if (shift > 63U) throw Fault("a number that is too large");
      value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
      if (byte < 0x80U) break;
    }
    if (value > largest) throw Fault("a number that is too large");
    return value;
  }
  template <class Id>
  Id id() {
    const auto slot = static_cast<std::uint32_t>(varint(UINT32_MAX));
    return {slot, static_cast<std::uint32_t>(varint(UINT32_MAX))};
  }
  /// How many entries follow, each of at least `bytes_each`: never more than the bytes can hold.
  std::size_t count(std::size_t bytes_each) {
    return static_cast<std::size_t>(varint(rest_.size() / bytes_each));
  }

  bool done() const { return rest_.empty(); }
  void expect_end() const {
    if (!done()) throw Fault("bytes left over");
  }

 private:
  std::string_view take(std::size_t size) {
    if (rest_.size() < size) throw Fault("bytes missing");
    const std::string_view bytes = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return bytes;
  }
  std::string_view rest_;
};

}  // namespace ydd::map_format
