// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/timestamp.h"

#include <charconv>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

namespace ydd {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

std::optional<std::int64_t> parse_digits(std::string_view digits) {
  std::int64_t value = 0;
  const auto [end, ec] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (ec != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

std::optional<Timestamp> parse_scientific(std::string_view text) {
  double value = 0.0;
  const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = ec == std::errc() && end == text.data() + text.size();
  if (!whole || !std::isfinite(value) || std::abs(value) > double(kLatestStamp_s))
    return std::nullopt;
  return Timestamp{std::llround(value * 1e9)};
}

}  // namespace

std::optional<Timestamp> parse_timestamp(std::string_view text) {
  if (text.find_first_of("eE") != std::string_view::npos) return parse_scientific(text);
  const bool negative = !text.empty() && text.front() == '-';
  if (negative) text.remove_prefix(1);
  if (text.empty() || text.front() == '-') return std::nullopt;
  const std::size_t dot = text.find('.');
  const std::string_view whole = text.substr(0, dot);
  std::string fraction(dot == std::string_view::npos ? "" : text.substr(dot + 1));
  if (fraction.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  fraction.resize(9, '0');
  const auto seconds = whole.empty() ? std::optional<std::int64_t>(0) : parse_digits(whole);
  const auto ns = parse_digits(fraction);
  if (!seconds || !ns || *seconds > kLatestStamp_s || (whole.empty() && text.size() < 2)) {
    return std::nullopt;
  }
  const std::int64_t total = *seconds * kNsPerSecond + *ns;
  return Timestamp{negative ? -total : total};
}

std::string format_timestamp(Timestamp stamp) {
  const char* sign = stamp.ns < 0 ? "-" : "";
  const std::int64_t magnitude = std::abs(stamp.ns);
  return fmt::format("{}{}.{:09d}", sign, magnitude / kNsPerSecond, magnitude % kNsPerSecond);
}

}  // namespace ydd
