// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/text_table.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ydd/base/files.h"

namespace ydd {

namespace {

constexpr std::string_view kBlanks = " \t\r\f\v";

std::string_view trimmed(std::string_view text, std::string_view unwanted = kBlanks) {
  const std::size_t first = text.find_first_not_of(unwanted);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(unwanted) - first + 1);
}

std::vector<std::string> split(std::string_view line, std::string_view separators) {
  std::vector<std::string> fields;
  while (true) {
    const std::size_t first = line.find_first_not_of(separators);
    if (first == std::string_view::npos) return fields;
    const std::size_t end = std::min(line.find_first_of(separators, first), line.size());
    fields.emplace_back(trimmed(line.substr(first, end - first), "\"'"));
    line.remove_prefix(end);
  }
}

bool has_comma(std::string_view line) { return line.find_first_of(",;") != std::string_view::npos; }

/// "p_RS_R_x [m]" is "p_x", "field.pose.position.x" is "x" of it.
std::string column_name(std::string_view text) {
  std::string name;
  for (const char c : trimmed(text.substr(0, text.find('[')))) {
    name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  for (const std::string_view frame : {"_rs_r", "_rs", "_wb", "_wc"}) {
    const std::size_t at = name.find(frame);
    if (at != std::string::npos) name.erase(at, frame.size());
  }
  return name;
}

/// Whether the line names columns: it says what the first one is.
bool take_header(std::string_view line, TextTable& table) {
  line = trimmed(line, "# \t\r");
  const std::vector<std::string> names = has_comma(line) ? split(line, ",;") : split(line, kBlanks);
  std::vector<std::string> columns;
  for (const std::string& name : names) columns.push_back(column_name(name));
  const bool is_header = columns.size() > 1 && (columns[0] == "timestamp" || columns[0] == "time" ||
                                                columns[0] == "stamp" || columns[0] == "t");
  if (!is_header) return false;
  table.columns = std::move(columns);
  for (const auto& [unit, ns] : {std::pair{"[s]", 1'000'000'000}, std::pair{"[ms]", 1'000'000},
                                 std::pair{"[us]", 1'000}, std::pair{"[ns]", 1}}) {
    if (names[0].find(unit) != std::string::npos) table.unit_ns = ns;
  }
  return true;
}

Result<std::string> read_text(const std::filesystem::path& file) {
  Result<std::string> text = read_file(file);
  if (!text) return text;
  if (text->starts_with("\xFF\xFE") || text->starts_with("\xFE\xFF")) {
    return Error{fmt::format("{}: is UTF-16 text; save it as UTF-8", file.string())};
  }
  if (text->starts_with("\xEF\xBB\xBF")) text->erase(0, 3);  // a byte order mark
  return text;
}

}  // namespace

Result<TextTable> read_text_table(const std::filesystem::path& file) {
  const Result<std::string> text = read_text(file);
  if (!text) return text.error();
  std::istringstream stream(*text);
  TextTable table;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string_view content = trimmed(line);
    if (content.empty()) continue;
    const bool first = table.rows.empty();  // what stands between rows is no header
    if (content.front() == '#') {
      if (first) take_header(content, table);
      continue;
    }
    if (first && table.columns.empty() && take_header(content, table)) continue;
    if (first) table.commas = has_comma(content);
    TextRow row{split(content, " \t\r\f\v,;"), number};
    if (!row.fields.empty()) table.rows.push_back(std::move(row));
  }
  return table;
}

std::optional<std::size_t> find_column(const TextTable& table,
                                       std::initializer_list<std::string_view> names) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (std::find(names.begin(), names.end(), table.columns[i]) != names.end()) return i;
  }
  return std::nullopt;
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

Result<Timestamp> field_stamp(const std::filesystem::path& file, const TextTable& table,
                              const TextRow& row, std::size_t field) {
  constexpr std::size_t kNanosecondDigits = 17;  // since 1973; seconds have 10 in this century
  constexpr std::size_t kMicrosecondDigits = 15;
  constexpr std::size_t kMillisecondDigits = 12;
  constexpr std::size_t kMostDigits = 19;
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::string& text = row.fields[field];
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  const std::size_t digits = text.size() - sign;
  const bool whole = digits > 0 && text.find_first_not_of("0123456789", sign) == std::string::npos;
  const bool other_unit = table.unit_ns != 0 && table.unit_ns != kSecond_ns;
  if (other_unit && !whole) {
    return row_error(file, row,
                     fmt::format("'{}' is not a whole number of the header's unit", text));
  }
  if (whole && digits <= kMostDigits && (other_unit || digits >= kNanosecondDigits)) {
    const std::int64_t unit_ns = other_unit ? table.unit_ns : 1;
    std::int64_t count = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), count);
    const std::int64_t latest = kLatestStamp_s * (kSecond_ns / unit_ns);
    if (code == std::errc() && count >= -latest && count <= latest) {
      return Timestamp{count * unit_ns};
    }
  }
  if (whole && digits >= kMillisecondDigits && digits < kNanosecondDigits) {
    const char* const unit = digits >= kMicrosecondDigits ? "microseconds" : "milliseconds";
    return row_error(file, row,
                     fmt::format("'{}' is not a time in seconds; it looks like {}: write seconds, "
                                 "or nanoseconds below a header with '[ns]'",
                                 text, unit));
  }
  if (const auto stamp = parse_timestamp(text)) return *stamp;
  return row_error(file, row, fmt::format("'{}' is not a time in seconds", text));
}

Result<Timestamp> row_stamp(const std::filesystem::path& file, const TextTable& table,
                            const TextRow& row, const Timestamp* previous, std::size_t field) {
  const Result<Timestamp> stamp = field_stamp(file, table, row, field);
  if (!stamp) return stamp;
  if (previous && *stamp == *previous) {
    return row_error(file, row, fmt::format("duplicate stamp {}", row.fields[field]));
  }
  if (previous && *stamp < *previous) {
    return row_error(file, row,
                     fmt::format("stamp {} is earlier than the one before ({}); sort the file by "
                                 "time",
                                 row.fields[field], format_timestamp(*previous)));
  }
  return *stamp;
}

}  // namespace ydd
