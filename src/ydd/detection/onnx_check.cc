// SPDX-License-Identifier: Apache-2.0
// Own look at an ONNX file before a library gets it: protobuf readers print to standard error, and
// "failed to parse" does not tell a half-copied file from a picture.
#include <cstddef>
#include <cstdint>
#include <optional>

#include <fmt/format.h>

#include "ydd/detection/network.h"

namespace ydd {
namespace {

/// Base 128, least significant group first (protobuf encoding, "Base 128 Varints").
std::optional<std::uint64_t> take_varint(std::string_view& bytes) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64 && !bytes.empty(); shift += 7) {
    const auto byte = static_cast<std::uint8_t>(bytes.front());
    bytes.remove_prefix(1);
    value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
    if ((byte & 0x80U) == 0) return value;
  }
  return std::nullopt;
}

Error truncated(std::uint64_t missing) {
  return {fmt::format("truncated: at least {} more bytes are needed; copy it again", missing)};
}

/// Skips the value of one field. ONNX uses the wire types 0 (number), 2 (bytes), 1 and 5 (fixed).
Result<void> skip_value(std::string_view& bytes, std::uint64_t wire_type) {
  std::optional<std::uint64_t> size;
  switch (wire_type) {
    case 0:
      return take_varint(bytes) ? Result<void>{} : truncated(1);
    case 1:
      size = 8;
      break;
    case 2:
      size = take_varint(bytes);
      if (!size) return truncated(1);
      break;
    case 5:
      size = 4;
      break;
    default:
      return Error{"not an ONNX file"};
  }
  if (*size > bytes.size()) return truncated(*size - bytes.size());
  bytes.remove_prefix(static_cast<std::size_t>(*size));
  return {};
}

}  // namespace

Result<void> check_onnx(std::string_view bytes) {
  constexpr std::uint64_t kIrVersion = 1;  // field numbers of ModelProto
  constexpr std::uint64_t kGraph = 7;
  constexpr std::uint64_t kOperatorSet = 8;
  constexpr std::uint64_t kLastField = 26;
  bool has_graph = false;
  bool has_operator_set = false;
  bool is_first = true;
  while (!bytes.empty()) {
    const std::optional<std::uint64_t> tag = take_varint(bytes);
    const std::uint64_t field = tag.value_or(0) >> 3U;
    // Exporters begin with the version; anything else is not a model at all.
    if (is_first && field != kIrVersion) return Error{"not an ONNX file"};
    if (!tag) return truncated(1);
    if (field == 0 || field > kLastField) return Error{"not an ONNX file"};
    if (auto skipped = skip_value(bytes, *tag & 7U); !skipped) return skipped;
    has_graph = has_graph || field == kGraph;
    has_operator_set = has_operator_set || field == kOperatorSet;
    is_first = false;
  }
  // Both are obligatory, and one of them comes last: without it the file ends too early.
  if (!has_graph || !has_operator_set) return truncated(1);
  return {};
}

}  // namespace ydd
