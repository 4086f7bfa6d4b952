// SPDX-License-Identifier: Apache-2.0
#include "progress.h"

#include <unistd.h>

#include <utility>

#include <fmt/format.h>

#include "ydd/base/log.h"
#include "ydd/base/timing.h"

namespace ydd::app {
namespace {

constexpr std::int64_t kTerminalInterval_ns = 100'000'000;
constexpr std::int64_t kLogInterval_ns = 5'000'000'000;

}  // namespace

Progress::Progress(std::string what, std::size_t total, bool quiet)
    : what_(std::move(what)),
      total_(total),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_ns_(wall_clock_ns()),
      shown_ns_(start_ns_) {}

Progress::~Progress() {
  if (line_open_) fmt::print(stderr, "\n");
}

void Progress::update(std::size_t done, const std::string& state) {
  if (quiet_) return;
  const std::int64_t now_ns = wall_clock_ns();
  const std::int64_t interval_ns = terminal_ ? kTerminalInterval_ns : kLogInterval_ns;
  if (now_ns - shown_ns_ < interval_ns && done < total_) return;
  if (!terminal_ && done == total_) return;
  shown_ns_ = now_ns;
  show(done, state, now_ns);
}

void Progress::show(std::size_t done, const std::string& state, std::int64_t now_ns) {
  const double elapsed_s = static_cast<double>(now_ns - start_ns_) * 1e-9;
  const double rate_hz = elapsed_s > 0 ? static_cast<double>(done) / elapsed_s : 0.0;
  const double left_s = rate_hz > 0 ? static_cast<double>(total_ - done) / rate_hz : 0.0;
  const std::string line = fmt::format("{} {}/{}  {:.1f} fps  {}  {:.0f} s left", what_, done,
                                       total_, rate_hz, state, left_s);
  if (terminal_) {
    fmt::print(stderr, "\r\x1b[K{}", line);
    line_open_ = true;
  } else {
    log::info("{}", line);
  }
}

}  // namespace ydd::app
