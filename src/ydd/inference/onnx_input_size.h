// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"

namespace ydd {

/// The same network (ONNX in memory) for inputs of this size alone: what the file says of its input
/// `name` becomes `shape` (batch, channels, height, width), all else stays as it is. For libraries
/// that compute sizes while they read. The failure does not name the file.
Result<std::string> with_input_size(std::string_view onnx, std::string_view name,
                                    const std::vector<int>& shape);

}  // namespace ydd
