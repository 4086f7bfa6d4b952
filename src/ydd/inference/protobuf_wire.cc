// SPDX-License-Identifier: Apache-2.0
#include "ydd/inference/protobuf_wire.h"

#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/byte_writer.h"

namespace ydd {
namespace {

Error truncated(std::uint64_t missing) {
  return {fmt::format("truncated: at least {} more bytes are needed; copy it again", missing)};
}

Result<std::string_view> take_bytes(std::string_view& bytes, std::uint64_t size) {
  if (size > bytes.size()) return truncated(size - bytes.size());
  const std::string_view taken = bytes.substr(0, static_cast<std::size_t>(size));
  bytes.remove_prefix(taken.size());
  return taken;
}

std::uint64_t little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    value = (value << 8U) | static_cast<std::uint8_t>(bytes[i]);
  }
  return value;
}

}  // namespace

std::string number_field(std::uint64_t id, std::uint64_t value) {
  ByteWriter out;
  out.varint(id << 3U);
  out.varint(value);
  return std::move(out).take();
}

std::string bytes_field(std::uint64_t id, std::string_view content) {
  ByteWriter out;
  out.varint((id << 3U) | 2U);
  out.varint(content.size());
  return std::move(out).take().append(content);
}

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

Result<WireField> take_field(std::string_view& bytes) {
  const std::optional<std::uint64_t> tag = take_varint(bytes);
  if (!tag) return truncated(1);
  WireField field;
  field.id = *tag >> 3U;
  const std::uint64_t wire_type = *tag & 7U;
  if (wire_type == 1 || wire_type == 5) {
    field.kind = wire_type == 1 ? WireField::Kind::fixed64 : WireField::Kind::fixed32;
    const Result<std::string_view> bits = take_bytes(bytes, wire_type == 1 ? 8 : 4);
    if (!bits) return bits.error();
    field.number = little_endian(*bits);
    return field;
  }
  if (wire_type != 0 && wire_type != 2) return Error{"not an ONNX file"};
  const std::optional<std::uint64_t> number = take_varint(bytes);
  if (!number) return truncated(1);
  field.number = *number;
  if (wire_type == 0) return field;
  field.kind = WireField::Kind::bytes;
  const Result<std::string_view> content = take_bytes(bytes, *number);
  if (!content) return content.error();
  field.bytes = *content;
  return field;
}

Result<void> append_integers(const WireField& field, std::vector<std::int64_t>& out) {
  if (field.kind == WireField::Kind::number) {
    out.push_back(static_cast<std::int64_t>(field.number));
    return {};
  }
  for (std::string_view rest = field.bytes; !rest.empty();) {
    const auto value = take_varint(rest);
    if (!value) return Error{"damaged: a list of integers ends too early"};
    out.push_back(static_cast<std::int64_t>(*value));
  }
  return {};
}

}  // namespace ydd
