// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/base/timestamp.h"

namespace ydd {

/// One line of a list or trajectory file.
struct TextRow {
  std::vector<std::string> fields;
  int line = 0;  ///< from 1
};

/// The lines of a text file of the TUM layout, split at blanks; empty lines and lines that start
/// with '#' are left out.
Result<std::vector<TextRow>> read_text_table(const std::filesystem::path& file);

/// "file:line: reason".
Error row_error(const std::filesystem::path& file, const TextRow& row, const std::string& reason);

/// The fields of `row`, one blank between two, cut to what fits on a line of an error.
std::string quoted(const TextRow& row);

/// The first field as a stamp that must be later than `previous` (unless that is null).
Result<Timestamp> row_stamp(const std::filesystem::path& file, const TextRow& row,
                            const Timestamp* previous);

}  // namespace ydd
