// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace ydd {

/// A checksum of bytes that are fed in pieces; piece boundaries count. Any change of up to eight
/// bytes in a row changes the sum for sure, any other with probability 1 - 2^-64: each step is a
/// bijection of what went before for a fixed word, and of the word for a fixed past.
class Checksum {
 public:
  void add(std::string_view bytes) {
    add(bytes.size());
    while (bytes.size() >= 8) {
      std::uint64_t word = 0;
      for (unsigned i = 0; i < 8; ++i) {
        word |= static_cast<std::uint64_t>(static_cast<std::uint8_t>(bytes[i])) << (8U * i);
      }
      add(word);
      bytes.remove_prefix(8);
    }
    for (const char c : bytes) add(static_cast<std::uint8_t>(c));
  }
  void add(std::uint64_t word) {
    sum_ = (sum_ ^ word) * 0x9E3779B97F4A7C15U;
    sum_ ^= sum_ >> 32U;
  }
  std::uint64_t value() const { return sum_; }

 private:
  std::uint64_t sum_ = 0x243F6A8885A308D3U;
};

}  // namespace ydd
