// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"

namespace ydd {

/// A constant of a network, row-major: numbers of one of the two kinds.
struct OnnxTensor {
  std::vector<std::int64_t> dims;
  std::vector<float> floats;
  std::vector<std::int64_t> integers;
};

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
};

/// Reads a model (onnx.proto; tensors of 32-bit floats and of 32- or 64-bit integers, inside the
/// file). The failure does not name the file.
Result<OnnxGraph> read_onnx(std::string_view bytes);

}  // namespace ydd
