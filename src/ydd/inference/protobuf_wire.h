// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"

namespace ydd {

/// One field of a protobuf message ("Encoding", protobuf.dev): its number and what it holds.
struct WireField {
  enum class Kind { number, fixed64, bytes, fixed32 };
  std::uint64_t id = 0;
  Kind kind = Kind::number;
  std::uint64_t number = 0;  ///< of number; of the two fixed kinds the bits
  std::string_view bytes;    ///< of bytes; a view of what is read
};

/// Base 128, least significant group first; nothing at the end of `bytes` or beyond 64 bits.
std::optional<std::uint64_t> take_varint(std::string_view& bytes);

/// Takes the first field off `bytes`. Fails with "truncated: ..." when more bytes are announced
/// than there are, and with "not an ONNX file" at a kind of field that ONNX does not use.
Result<WireField> take_field(std::string_view& bytes);

/// The other way: a field that holds a number, and one that holds bytes.
std::string number_field(std::uint64_t id, std::uint64_t value);
std::string bytes_field(std::uint64_t id, std::string_view content);

/// Calls `take(field)` for every field of a message; it gives a Result<void>.
template <class Take>
Result<void> for_each_field(std::string_view message, Take take) {
  while (!message.empty()) {
    const Result<WireField> field = take_field(message);
    if (!field) return field.error();
    if (Result<void> taken = take(*field); !taken) return taken;
  }
  return {};
}

/// A repeated integer: packed into one field, or one field each.
Result<void> append_integers(const WireField& field, std::vector<std::int64_t>& out);

}  // namespace ydd
