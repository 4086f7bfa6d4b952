// SPDX-License-Identifier: Apache-2.0
// Field numbers are those of onnx.proto. A reader of its own, because the ones that protobuf makes
// print to standard error, and need its compiler at build time, for these few messages.
#include "ydd/detection/onnx_graph.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "ydd/detection/protobuf_wire.h"

namespace ydd {
namespace {

using Kind = WireField::Kind;

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
Result<void> append_integers(const WireField& field, std::vector<std::int64_t>& out) {
  if (field.kind == Kind::number) {
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

template <class Raw, class Value>
void append_raw(std::string_view bytes, std::vector<Value>& out) {
  for (; bytes.size() >= sizeof(Raw); bytes.remove_prefix(sizeof(Raw))) {
    Raw value;
    std::memcpy(&value, bytes.data(), sizeof(Raw));
    out.push_back(static_cast<Value>(value));
  }
}

void append_floats(const WireField& field, std::vector<float>& out) {
  if (field.kind == Kind::fixed32) {
    out.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(field.number)));
  } else {
    append_raw<float>(field.bytes, out);
  }
}

struct NamedTensor {
  std::string name;
  OnnxTensor tensor;
};

Result<void> check_size(const NamedTensor& named) {
  std::uint64_t size = 1;
  for (const std::int64_t d : named.tensor.dims) {
    if (d < 0 || d > (std::int64_t{1} << 31)) return Error{"damaged: a tensor of negative size"};
    size *= static_cast<std::uint64_t>(d);
    if (size > (std::uint64_t{1} << 40U)) return Error{"damaged: a tensor of impossible size"};
  }
  const std::size_t held = std::max(named.tensor.floats.size(), named.tensor.integers.size());
  if (held == size) return {};
  return Error{
      fmt::format("damaged: tensor '{}' holds {} numbers instead of {}", named.name, held, size)};
}

Result<NamedTensor> read_tensor(std::string_view message) {
  constexpr std::uint64_t kFloat = 1;
  constexpr std::uint64_t kInt32 = 6;
  constexpr std::uint64_t kInt64 = 7;
  NamedTensor out;
  std::uint64_t type = 0;
  std::string_view raw;
  bool external = false;
  auto read = for_each_field(message, [&](const WireField& f) -> Result<void> {
    if (f.id == 1) return append_integers(f, out.tensor.dims);
    if (f.id == 2) type = f.number;
    if (f.id == 4) append_floats(f, out.tensor.floats);
    if (f.id == 5 || f.id == 7) return append_integers(f, out.tensor.integers);
    if (f.id == 8) out.name = f.bytes;
    if (f.id == 9) raw = f.bytes;
    if (f.id == 14) external = f.number != 0;
    return {};
  });
  if (!read) return read.error();
  if (external) return Error{fmt::format("tensor '{}' lies in a file of its own", out.name)};
  if (type != kFloat && type != kInt32 && type != kInt64) {
    return Error{
        fmt::format("tensor '{}' holds numbers of ONNX type {}; only 32-bit floats and "
                    "integers are read",
                    out.name, type)};
  }
  if (type == kFloat) append_raw<float>(raw, out.tensor.floats);
  if (type == kInt32) append_raw<std::int32_t>(raw, out.tensor.integers);
  if (type == kInt64) append_raw<std::int64_t>(raw, out.tensor.integers);
  if (auto fits = check_size(out); !fits) return fits.error();
  return out;
}

Result<void> read_attribute(std::string_view message, OnnxNode& node) {
  std::string name;
  OnnxAttribute attribute;
  auto read = for_each_field(message, [&](const WireField& f) -> Result<void> {
    if (f.id == 1) name = f.bytes;
    if (f.id == 2 || f.id == 7) append_floats(f, attribute.floats);
    if (f.id == 3 || f.id == 8) return append_integers(f, attribute.integers);
    if (f.id == 4) attribute.text = f.bytes;
    if (f.id != 5) return {};
    Result<NamedTensor> tensor = read_tensor(f.bytes);
    if (!tensor) return tensor.error();
    attribute.tensor = std::move(tensor->tensor);
    return {};
  });
  if (read) node.attributes[name] = std::move(attribute);
  return read;
}

Result<OnnxNode> read_node(std::string_view message) {
  OnnxNode node;
  auto read = for_each_field(message, [&](const WireField& f) -> Result<void> {
    if (f.id == 1) node.inputs.emplace_back(f.bytes);
    if (f.id == 2) node.outputs.emplace_back(f.bytes);
    if (f.id == 4) node.op = f.bytes;
    if (f.id == 5) return read_attribute(f.bytes, node);
    return {};
  });
  if (!read) return read.error();
  return node;
}

Result<std::string> read_name(std::string_view value_info) {
  std::string name;
  auto read = for_each_field(value_info, [&](const WireField& f) -> Result<void> {
    if (f.id == 1) name = f.bytes;
    return {};
  });
  if (!read) return read.error();
  return name;
}

Result<void> add_node(std::string_view message, OnnxGraph& graph) {
  Result<OnnxNode> node = read_node(message);
  if (!node) return node.error();
  if (node->op == "Constant" && node->attributes.contains("value") && node->outputs.size() == 1) {
    graph.constants[node->outputs[0]] = std::move(node->attributes["value"].tensor);
  } else {
    graph.nodes.push_back(std::move(*node));
  }
  return {};
}

Result<OnnxGraph> read_graph(std::string_view message) {
  OnnxGraph graph;
  auto read = for_each_field(message, [&](const WireField& f) -> Result<void> {
    if (f.id == 1) return add_node(f.bytes, graph);
    if (f.id == 5) {
      Result<NamedTensor> tensor = read_tensor(f.bytes);
      if (!tensor) return tensor.error();
      graph.constants[tensor->name] = std::move(tensor->tensor);
    }
    if (f.id == 11 || f.id == 12) {
      Result<std::string> name = read_name(f.bytes);
      if (!name) return name.error();
      (f.id == 11 ? graph.inputs : graph.outputs).push_back(std::move(*name));
    }
    return {};
  });
  if (!read) return read.error();
  std::erase_if(graph.inputs,
                [&](const std::string& name) { return graph.constants.contains(name); });
  return graph;
}

}  // namespace

std::int64_t OnnxNode::integer(std::string_view attribute, std::int64_t otherwise) const {
  const auto found = attributes.find(attribute);
  return found == attributes.end() || found->second.integers.empty()
             ? otherwise
             : found->second.integers.front();
}

std::vector<std::int64_t> OnnxNode::integers(std::string_view attribute,
                                             const std::vector<std::int64_t>& otherwise) const {
  const auto found = attributes.find(attribute);
  return found == attributes.end() ? otherwise : found->second.integers;
}

float OnnxNode::number(std::string_view attribute, float otherwise) const {
  const auto found = attributes.find(attribute);
  return found == attributes.end() || found->second.floats.empty() ? otherwise
                                                                   : found->second.floats.front();
}

std::string OnnxNode::text(std::string_view attribute, const std::string& otherwise) const {
  const auto found = attributes.find(attribute);
  return found == attributes.end() ? otherwise : found->second.text;
}

Result<OnnxGraph> read_onnx(std::string_view bytes) {
  constexpr std::uint64_t kGraph = 7;
  std::string_view graph;
  auto read = for_each_field(bytes, [&](const WireField& f) -> Result<void> {
    if (f.id == kGraph) graph = f.bytes;
    return {};
  });
  if (!read) return read.error();
  if (graph.empty()) return Error{"holds no network"};
  return read_graph(graph);
}

}  // namespace ydd
