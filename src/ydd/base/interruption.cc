// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/interruption.h"

#include <csignal>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <ctime>
#include <thread>

namespace ydd::interruption {
namespace {

/// `timeout` signals the process and then its group: that is one wish, not two.
constexpr std::int64_t kOneWish_ns = 250'000'000;

std::atomic<int> asked{0};
std::atomic<std::int64_t> asked_ns{0};
static_assert(std::atomic<int>::is_always_lock_free &&  // a handler may touch nothing else
              std::atomic<std::int64_t>::is_always_lock_free);

std::int64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

extern "C" void remember(int number) {
  const std::int64_t now = now_ns();
  std::int64_t never = 0;
  if (asked_ns.compare_exchange_strong(never, now)) {
    asked.store(number);
    return;
  }
  if (now - asked_ns.load() < kOneWish_ns) return;
  // Whoever asks twice will not wait.
  std::signal(number, SIG_DFL);
  std::raise(number);
}

}  // namespace

void catch_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before = {};
    if (::sigaction(number, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    struct sigaction action = {};
    action.sa_handler = remember;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    ::sigaction(number, &action, nullptr);
  }
}

void survive_failed_writes() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int signal() { return asked.load(); }

void forgive() { asked.store(0); }

std::string signal_name() {
  switch (signal()) {
    case SIGINT:
      return "SIGINT";
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "SIGHUP";
    default:
      return "";
  }
}

Interrupted::Interrupted()
    : what_(signal_name() + " asked to end; what was not finished is gone") {}

void throw_if_asked() {
  if (signal() != 0) throw Interrupted();
}

bool sleep_until(std::chrono::steady_clock::time_point when) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kLongestNap = std::chrono::milliseconds(50);
  while (signal() == 0) {
    const auto now = Clock::now();
    if (now >= when) return true;
    std::this_thread::sleep_for(std::min<Clock::duration>(kLongestNap, when - now));
  }
  return false;
}

}  // namespace ydd::interruption
