// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "ydd/base/result.h"

namespace ydd::app {

/// Creates the folder of a run: `out`, or runs/<sequence>-<time> when `out` is empty, and then lets
/// runs/latest point at it.
Result<std::filesystem::path> make_run_folder(const std::string& out, const std::string& sequence);

}  // namespace ydd::app
