// SPDX-License-Identifier: Apache-2.0
#include "ydd/messages/wire_reader.h"

#include <bit>

namespace ydd {

WireReader::WireReader(std::string_view message, Wire wire) : rest_(message), wire_(wire) {
  if (wire == Wire::ros1) return;
  // Representation identifier (0, 0: plain CDR, big endian; 0, 1: little endian) and two options.
  const std::string_view head = take(4, 1);
  taken_ = 0;
  if (!ok_) return;
  big_endian_ = head[1] == 0;
  ok_ = head[0] == 0 && (head[1] == 0 || head[1] == 1);
}

std::string_view WireReader::take(std::size_t size, std::size_t alignment) {
  const std::size_t padding =
      wire_ == Wire::cdr ? (alignment - taken_ % alignment) % alignment : std::size_t{0};
  ok_ = ok_ && rest_.size() >= padding && rest_.size() - padding >= size;
  if (!ok_) return {};
  const std::string_view out = rest_.substr(padding, size);
  rest_.remove_prefix(padding + size);
  taken_ += padding + size;
  return out;
}

std::uint64_t WireReader::number(std::size_t size) {
  const std::string_view bytes = take(size, size);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::size_t at = big_endian_ ? i : bytes.size() - 1 - i;
    value = value << 8U | static_cast<unsigned char>(bytes[at]);
  }
  return value;
}

std::uint8_t WireReader::u8() { return static_cast<std::uint8_t>(number(1)); }
std::uint32_t WireReader::u32() { return static_cast<std::uint32_t>(number(4)); }
double WireReader::f64() { return std::bit_cast<double>(number(8)); }

std::string_view WireReader::text() {
  std::string_view text = bytes();
  if (wire_ == Wire::cdr && !text.empty() && text.back() == '\0') text.remove_suffix(1);
  return text;
}

std::string_view WireReader::bytes() {
  const std::uint32_t size = u32();
  return take(size, 1);
}

std::vector<double> WireReader::f64_sequence(std::size_t most) {
  const std::uint32_t size = u32();
  ok_ = ok_ && size <= most;
  std::vector<double> out;
  for (std::size_t i = 0; ok_ && i < size; ++i) out.push_back(f64());
  return out;
}

Timestamp WireReader::stamp() {
  const std::uint32_t seconds = u32(), nanoseconds = u32();
  return {std::int64_t{seconds} * 1'000'000'000 + nanoseconds};
}

}  // namespace ydd
