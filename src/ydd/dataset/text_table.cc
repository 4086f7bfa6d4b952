// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/text_table.h"

#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ydd/base/files.h"

namespace ydd {

Result<std::vector<TextRow>> read_text_table(const std::filesystem::path& file) {
  const Result<std::string> text = read_file(file);
  if (!text) return text.error();
  std::istringstream stream(*text);
  std::vector<TextRow> rows;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    TextRow row;
    row.line = number;
    std::istringstream words(line);  // a carriage return counts as blank
    for (std::string word; words >> word;) row.fields.push_back(std::move(word));
    const bool is_comment = row.fields.empty() || row.fields.front().front() == '#';
    if (!is_comment) rows.push_back(std::move(row));
  }
  return rows;
}

Error row_error(const std::filesystem::path& file, const TextRow& row, const std::string& reason) {
  return Error{fmt::format("{}:{}: {}", file.string(), row.line, reason)};
}

std::string quoted(const TextRow& row) {
  constexpr std::size_t kLongest = 60;
  std::string text = fmt::format("{}", fmt::join(row.fields, " "));
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return "'" + text + "'";
}

Result<Timestamp> row_stamp(const std::filesystem::path& file, const TextRow& row,
                            const Timestamp* previous) {
  const auto stamp = parse_timestamp(row.fields.front());
  if (!stamp) {
    return row_error(file, row, fmt::format("'{}' is not a time in seconds", row.fields.front()));
  }
  if (previous && *stamp == *previous) {
    return row_error(file, row, fmt::format("duplicate stamp {}", row.fields.front()));
  }
  if (previous && *stamp < *previous) {
    return row_error(file, row,
                     fmt::format("stamp {} is earlier than the one before ({}); sort the file by "
                                 "time",
                                 row.fields.front(), format_timestamp(*previous)));
  }
  return *stamp;
}

}  // namespace ydd
