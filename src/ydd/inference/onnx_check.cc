// SPDX-License-Identifier: Apache-2.0
// Own look at an ONNX file before a library gets it: protobuf readers print to standard error, and
// "failed to parse" does not tell a half-copied file from a picture.
#include <cstdint>

#include "ydd/inference/network.h"
#include "ydd/inference/protobuf_wire.h"

namespace ydd {

Result<void> check_onnx(std::string_view bytes) {
  constexpr char kFirstByte = 1 << 3;  // field ir_version, a number
  constexpr std::uint64_t kGraph = 7;  // field numbers of ModelProto
  constexpr std::uint64_t kOperatorSet = 8;
  constexpr std::uint64_t kLastField = 26;
  bool has_graph = false;
  bool has_operator_set = false;
  bool is_first = true;
  while (!bytes.empty()) {
    // Exporters begin with the version; anything else is not a model at all.
    if (is_first && bytes.front() != kFirstByte) return Error{"not an ONNX file"};
    const Result<WireField> field = take_field(bytes);
    if (!field) return field.error();
    if (field->id == 0 || field->id > kLastField) return Error{"not an ONNX file"};
    has_graph = has_graph || field->id == kGraph;
    has_operator_set = has_operator_set || field->id == kOperatorSet;
    is_first = false;
  }
  // Both are obligatory, and one of them comes last: without it the file ends too early.
  if (!has_graph || !has_operator_set) {
    return Error{"truncated: at least 1 more bytes are needed; copy it again"};
  }
  return {};
}

}  // namespace ydd
