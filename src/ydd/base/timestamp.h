// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace ydd {

/// Nanoseconds since the epoch of the recording, exact: 1305031102.175304 s keeps its digits.
struct Timestamp {
  std::int64_t ns = 0;  ///< nanoseconds

  /// As a plain number, which keeps microseconds of today's times.
  double seconds() const { return static_cast<double>(ns) * 1e-9; }
  friend auto operator<=>(const Timestamp&, const Timestamp&) = default;
};

/// The latest whole second that a stamp from a file may have: some time in the year 2255, which is
/// as far as 64 bits of nanoseconds reach.
inline constexpr std::int64_t kLatestStamp_s = 9'000'000'000;

/// `b - a` in seconds.
inline double seconds_between(Timestamp a, Timestamp b) {
  return static_cast<double>(b.ns - a.ns) * 1e-9;
}

/// Parses decimal seconds ("1305031102.175304", also "12" or "1.3e9"). Digits beyond nanoseconds
/// are cut off. Nothing when `text` is not one number.
std::optional<Timestamp> parse_timestamp(std::string_view text);

/// Decimal seconds with nine decimals.
std::string format_timestamp(Timestamp stamp);

}  // namespace ydd
