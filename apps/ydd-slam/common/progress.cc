// SPDX-License-Identifier: Apache-2.0
#include "common/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/log.h"
#include "ydd/base/timing.h"

namespace ydd::app {
namespace {

constexpr std::int64_t kTerminalInterval_ns = 100'000'000;
constexpr std::int64_t kLogInterval_ns = 5'000'000'000;

/// A line that is longer than the terminal is wide could not be rewritten.
std::size_t terminal_columns() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col - 1U : 79U;
}

std::string duration_text(double seconds) {
  const auto s = static_cast<std::int64_t>(std::lround(seconds));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{}:{:02d} min", s / 60, s % 60);
  return fmt::format("{}:{:02d} h", s / 3600, s / 60 % 60);
}

}  // namespace

Progress::Progress(std::string what, std::size_t total, bool quiet)
    : what_(std::move(what)),
      total_(total),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_ns_(wall_clock_ns()),
      shown_ns_(start_ns_) {}

Progress::~Progress() {
  if (!line_open_) return;
  log::set_over_open_line(false);
  fmt::print(stderr, "\n");
}

void Progress::update(std::size_t done, const std::string& state) {
  if (quiet_) return;
  const std::int64_t now_ns = wall_clock_ns();
  const std::int64_t interval_ns = terminal_ ? kTerminalInterval_ns : kLogInterval_ns;
  const bool goes_on = total_ == 0 || done < total_;
  if (now_ns - shown_ns_ < interval_ns && goes_on) return;
  if (!terminal_ && !goes_on) return;
  shown_ns_ = now_ns;
  show(done, state, now_ns);
}

void Progress::show(std::size_t done, const std::string& state, std::int64_t now_ns) {
  const double elapsed_s = static_cast<double>(now_ns - start_ns_) * 1e-9;
  const double rate_hz = elapsed_s > 0 ? static_cast<double>(done) / elapsed_s : 0.0;
  const double left_s = rate_hz > 0 ? static_cast<double>(total_ - done) / rate_hz : 0.0;
  const std::string of = total_ > 0 ? fmt::format("/{}", total_) : "";
  std::string line = fmt::format("{} {}{}  {:.1f} fps", what_, done, of, rate_hz);
  if (!state.empty()) line += "  " + state;
  line += "  " + (done < total_ ? duration_text(left_s) + " left" : duration_text(elapsed_s));
  if (terminal_) {
    fmt::print(stderr, "\r\x1b[K{}", line.substr(0, terminal_columns()));
    if (!line_open_) log::set_over_open_line(true);
    line_open_ = true;
  } else {
    log::info("{}", line);
  }
}

}  // namespace ydd::app
