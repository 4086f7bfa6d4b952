// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/base/timestamp.h"

namespace ydd {

/// One line of a list or trajectory file.
struct TextRow {
  std::vector<std::string> fields;
  int line = 0;  ///< from 1
};

/// A list or trajectory as somebody wrote it.
struct TextTable {
  std::vector<TextRow> rows;
  std::vector<std::string> columns;  ///< names of a header, in small letters, without units
  std::int64_t unit_ns = 0;          ///< of the first column, as the header says; 0: it does not
  bool commas = false;               ///< between the fields of the first row
};

/// The lines of a text file, split at blanks, commas and semicolons; quotes around a field go.
/// Empty lines and lines that start with '#' are left out; such a line, or a first line of words,
/// may name the columns ("#timestamp [ns],p_x [m],..." as EuRoC has it).
Result<TextTable> read_text_table(const std::filesystem::path& file);

/// The column with one of these names; nothing when the header names none of them.
std::optional<std::size_t> find_column(const TextTable& table,
                                       std::initializer_list<std::string_view> names);

/// "file:line: reason".
Error row_error(const std::filesystem::path& file, const TextRow& row, const std::string& reason);

/// The fields of `row`, one blank between two, cut to what fits on a line of an error.
std::string quoted(const TextRow& row);

/// A field as a stamp: seconds, or nanoseconds where the header says so or where a whole number is
/// so long that it can be nothing else. Other units are recognised, not guessed.
Result<Timestamp> field_stamp(const std::filesystem::path& file, const TextTable& table,
                              const TextRow& row, std::size_t field);

/// The same, and it must be later than `previous` (unless that is null).
Result<Timestamp> row_stamp(const std::filesystem::path& file, const TextTable& table,
                            const TextRow& row, const Timestamp* previous, std::size_t field = 0);

}  // namespace ydd
