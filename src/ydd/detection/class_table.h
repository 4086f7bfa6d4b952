// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ydd/base/result.h"

namespace ydd {

/// Reads the class names of a network, in the order of its outputs, from YAML of the form
///
///     names: [person, bicycle, car]          or          names: {0: person, 1: bicycle, 2: car}
///
/// Other keys are ignored, so that the data files that trainers write can be used as they are.
/// Fails with one line "file:line: ..." when there is no such list, a name is empty or named twice,
/// or a numbered list has gaps.
Result<std::vector<std::string>> read_class_table(const std::filesystem::path& file);

}  // namespace ydd
