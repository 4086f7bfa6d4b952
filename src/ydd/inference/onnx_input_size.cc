// SPDX-License-Identifier: Apache-2.0
#include "ydd/inference/onnx_input_size.h"

#include <cstdint>

#include "ydd/inference/protobuf_wire.h"

namespace ydd {
namespace {

// Numbers of fields of onnx.proto, by message.
constexpr std::uint64_t kModelGraph = 7;
constexpr std::uint64_t kGraphInput = 11;
constexpr std::uint64_t kValueName = 1, kValueType = 2;
constexpr std::uint64_t kTypeTensor = 1;
constexpr std::uint64_t kTensorShape = 2;
constexpr std::uint64_t kShapeDim = 1;
constexpr std::uint64_t kDimValue = 1;

/// A copy of a message in which `change` has put another content into each of its fields `id`;
/// `change` gives a Result<std::string>.
template <class Change>
Result<std::string> with_field(std::string_view message, std::uint64_t id, Change change) {
  std::string out;
  out.reserve(message.size() + 64);
  while (!message.empty()) {
    const std::string_view before = message;
    const Result<WireField> field = take_field(message);
    if (!field) return field.error();
    if (field->id != id || field->kind != WireField::Kind::bytes) {
      out += before.substr(0, before.size() - message.size());
      continue;
    }
    const Result<std::string> changed = change(field->bytes);
    if (!changed) return changed.error();
    out += bytes_field(id, *changed);
  }
  return out;
}

Result<std::string_view> name_of(std::string_view value) {
  std::string_view name;
  const Result<void> read = for_each_field(value, [&](const WireField& field) -> Result<void> {
    if (field.id == kValueName) name = field.bytes;
    return {};
  });
  if (!read) return read.error();
  return name;
}

std::string shape_message(const std::vector<int>& shape) {
  std::string out;
  for (const int size : shape) {
    out += bytes_field(kShapeDim, number_field(kDimValue, static_cast<std::uint64_t>(size)));
  }
  return out;
}

}  // namespace

Result<std::string> with_input_size(std::string_view onnx, std::string_view name,
                                    const std::vector<int>& shape) {
  const auto resized_tensor = [&](std::string_view tensor) {
    return with_field(tensor, kTensorShape, [&](std::string_view) -> Result<std::string> {
      return shape_message(shape);
    });
  };
  const auto resized_value = [&](std::string_view value) -> Result<std::string> {
    const Result<std::string_view> named = name_of(value);
    if (!named) return named.error();
    if (*named != name) return std::string(value);
    return with_field(value, kValueType, [&](std::string_view type) {
      return with_field(type, kTypeTensor, resized_tensor);
    });
  };
  return with_field(onnx, kModelGraph, [&](std::string_view graph) {
    return with_field(graph, kGraphInput, resized_value);
  });
}

}  // namespace ydd
