// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "ydd/base/result.h"

namespace ydd {

/// Writes `content` to a temporary file beside `file`, flushes it to disk and renames it: readers
/// see the old file or the whole new one.
Result<void> write_file_atomically(const std::filesystem::path& file, std::string_view content);

/// The whole file.
Result<std::string> read_file(const std::filesystem::path& file);

}  // namespace ydd
