// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/base/result.h"
#include "ydd/inference/onnx_graph.h"

namespace ydd {

/// Whether all values of a graph can be computed for an input of this size: windows lie inside of
/// what they look at, channels fit, and nothing becomes larger than kMostNumbers. Sizes are
/// computed in 64 bits; where an operator's result depends on more than sizes and constants, its
/// largest possible one counts. An empty `input_dims` checks what holds for every input. The
/// failure names the operator.
Result<void> check_sizes(const OnnxGraph& graph, const std::vector<std::int64_t>& input_dims);

}  // namespace ydd
