// SPDX-License-Identifier: Apache-2.0
// Field numbers are those of onnx.proto. A reader of its own, because the ones that protobuf makes
// print to standard error, and need its compiler at build time, for these few messages.
#include "ydd/inference/onnx_graph.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/yaml_reader.h"
#include "ydd/inference/protobuf_wire.h"

namespace ydd {
namespace {

/// Attributes may hold graphs, whose operators have attributes.
constexpr int kDeepest = 8;

Result<OnnxGraph> read_graph(std::string_view message, int depth);

/// A graph inside an operator (If, Loop) is not kept, but no less to be sound.
Result<void> check_inner(std::string_view message, int depth) {
  if (depth >= kDeepest) return Error{"has graphs within graphs, too deep"};
  const Result<OnnxGraph> inner = read_graph(message, depth + 1);
  return inner ? Result<void>{} : Result<void>{inner.error()};
}

Result<void> read_attribute(std::string_view message, OnnxNode& node, int depth) {
  std::string name;
  OnnxAttribute attribute;
  auto read = for_each_field(message, [&](const WireField& f) -> Result<void> {
    if (f.id == 1) name = f.bytes;
    if (f.id == 2 || f.id == 7) append_floats(f, attribute.floats);
    if (f.id == 3 || f.id == 8) return append_integers(f, attribute.integers);
    if (f.id == 4) attribute.text = f.bytes;
    if (f.id == 6 || f.id == 11) return check_inner(f.bytes, depth);
    if (f.id != 5) return {};
    Result<NamedTensor> tensor = read_tensor(f.bytes);
    if (!tensor) return tensor.error();
    attribute.tensor = std::move(tensor->tensor);
    return {};
  });
  if (!read) return read;
  if (!node.attributes.emplace(name, std::move(attribute)).second) {
    return Error{fmt::format("damaged: {} has '{}' twice", describe(node), on_one_line(name))};
  }
  return {};
}

Result<OnnxNode> read_node(std::string_view message, int depth) {
  OnnxNode node;
  auto read = for_each_field(message, [&](const WireField& f) -> Result<void> {
    if (f.id == 1) node.inputs.emplace_back(f.bytes);
    if (f.id == 2) node.outputs.emplace_back(f.bytes);
    if (f.id == 4) node.op = f.bytes;
    if (f.id == 5) return read_attribute(f.bytes, node, depth);
    return {};
  });
  if (!read) return read.error();
  return node;
}

struct DeclaredValue {
  std::string name;
  std::vector<std::int64_t> dims;
};

/// TensorShapeProto: a dimension has a value, or a name, or nothing.
Result<std::vector<std::int64_t>> read_dims(std::string_view shape) {
  std::vector<std::int64_t> dims;
  auto read = for_each_field(shape, [&](const WireField& f) -> Result<void> {
    if (f.id != 1) return {};
    dims.push_back(-1);
    return for_each_field(f.bytes, [&](const WireField& d) -> Result<void> {
      if (d.id == 1) dims.back() = static_cast<std::int64_t>(d.number);
      return {};
    });
  });
  if (!read) return read.error();
  return dims;
}

/// ValueInfoProto: name, and type (1 of which is that of a tensor, 2 of which is its shape).
Result<DeclaredValue> read_value(std::string_view message) {
  DeclaredValue out;
  const auto read_tensor_type = [&](const WireField& f) -> Result<void> {
    if (f.id != 2) return {};
    auto dims = read_dims(f.bytes);
    if (!dims) return dims.error();
    out.dims = std::move(*dims);
    return {};
  };
  auto read = for_each_field(message, [&](const WireField& f) -> Result<void> {
    if (f.id == 1) out.name = f.bytes;
    if (f.id != 2) return {};
    return for_each_field(f.bytes, [&](const WireField& type) -> Result<void> {
      return type.id == 1 ? for_each_field(type.bytes, read_tensor_type) : Result<void>{};
    });
  });
  if (!read) return read.error();
  return out;
}

/// The value of a `Constant`, however it is spelled; null when it has none of the usual.
OnnxTensor* constant_of(OnnxNode& node) {
  if (node.op != "Constant" || node.outputs.size() != 1) return nullptr;
  if (const auto whole = node.attributes.find("value"); whole != node.attributes.end()) {
    return &whole->second.tensor;
  }
  for (const char* name : {"value_float", "value_floats", "value_int", "value_ints"}) {
    const auto found = node.attributes.find(name);
    if (found == node.attributes.end()) continue;
    OnnxAttribute& a = found->second;
    a.tensor.floats = a.floats;
    a.tensor.integers = a.integers;
    const std::size_t count = std::max(a.floats.size(), a.integers.size());
    if (std::string_view(name).ends_with('s')) {
      a.tensor.dims = {static_cast<std::int64_t>(count)};
    }
    return &a.tensor;
  }
  return nullptr;
}

Result<void> keep_constant(const std::string& name, OnnxTensor tensor, OnnxGraph& graph) {
  if (graph.constants.emplace(name, std::move(tensor)).second) return {};
  return Error{fmt::format("damaged: the constant '{}' is there twice", on_one_line(name))};
}

Result<void> add_node(std::string_view message, OnnxGraph& graph, int depth) {
  Result<OnnxNode> node = read_node(message, depth);
  if (!node) return node.error();
  if (OnnxTensor* constant = constant_of(*node)) {
    return keep_constant(node->outputs[0], std::move(*constant), graph);
  }
  graph.nodes.push_back(std::move(*node));
  return {};
}

Result<void> add_interface(const WireField& field, OnnxGraph& graph) {
  Result<DeclaredValue> value = read_value(field.bytes);
  if (!value) return value.error();
  constexpr std::uint64_t kInput = 11;
  (field.id == kInput ? graph.inputs : graph.outputs).push_back(value->name);
  graph.declared[value->name] = std::move(value->dims);
  return {};
}

Result<OnnxGraph> read_graph(std::string_view message, int depth) {
  OnnxGraph graph;
  auto read = for_each_field(message, [&](const WireField& f) -> Result<void> {
    if (f.id == 1) return add_node(f.bytes, graph, depth);
    if (f.id == 11 || f.id == 12) return add_interface(f, graph);
    if (f.id != 5) return {};
    Result<NamedTensor> tensor = read_tensor(f.bytes);
    if (!tensor) return tensor.error();
    return keep_constant(tensor->name, std::move(tensor->tensor), graph);
  });
  if (!read) return read.error();
  std::erase_if(graph.inputs,
                [&](const std::string& name) { return graph.constants.contains(name); });
  // An inner graph also reads values of the one around it.
  if (auto sound = depth == 0 ? check_graph(graph) : check_attributes(graph); !sound) {
    return sound.error();
  }
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
  return read_graph(graph, 0);
}

}  // namespace ydd
