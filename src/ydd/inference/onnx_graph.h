// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/inference/onnx_tensor.h"

namespace ydd {

/// A setting of an operator, of one of these kinds.
struct OnnxAttribute {
  std::vector<std::int64_t> integers;
  std::vector<float> floats;
  std::string text;
  OnnxTensor tensor;
};

/// One operator; names of values are unique in a graph, an empty name is an input left out.
struct OnnxNode {
  std::string op;
  std::vector<std::string> inputs, outputs;
  std::map<std::string, OnnxAttribute, std::less<>> attributes;

  std::int64_t integer(std::string_view attribute, std::int64_t otherwise) const;
  std::vector<std::int64_t> integers(std::string_view attribute,
                                     const std::vector<std::int64_t>& otherwise) const;
  float number(std::string_view attribute, float otherwise) const;
  std::string text(std::string_view attribute, const std::string& otherwise) const;
};

/// What an ONNX file says, as far as detectors need it; nodes in the order in which they can run.
struct OnnxGraph {
  std::vector<OnnxNode> nodes;  ///< without `Constant`: those are among the constants
  std::map<std::string, OnnxTensor, std::less<>> constants;
  std::vector<std::string> inputs;  ///< without those that are constants
  std::vector<std::string> outputs;
  /// What the file says about the sizes of inputs and outputs; -1: open.
  std::map<std::string, std::vector<std::int64_t>, std::less<>> declared;
};

/// Reads a model (onnx.proto) whose tensors lie inside the file, and checks all that can be told
/// without knowing the size of the input (check_graph). The failure does not name the file.
Result<OnnxGraph> read_onnx(std::string_view bytes);

/// Whether a graph can be computed at all: every value is made once, before it is read, operators
/// have the inputs that they need, and every number among their attributes is one that a network
/// can have, so that who computes with them needs no doubts (`strides: [4294967296, 1]` is 0 in 32
/// bits). The failure names the operator.
Result<void> check_graph(const OnnxGraph& graph);

/// Of these, the part about attributes.
Result<void> check_attributes(const OnnxGraph& graph);

/// "operator Conv (makes 'features')": for errors, on one line.
std::string describe(const OnnxNode& node);

}  // namespace ydd
