// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/interruption.h"

#include <csignal>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>

namespace ydd {
namespace {

using namespace std::chrono_literals;

TEST(Interruption, FirstSignalIsRememberedAndWakesSleepers) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        interruption::catch_signals();
        const bool slept = interruption::sleep_until(std::chrono::steady_clock::now() + 1ms);
        std::raise(SIGTERM);
        const bool woken = !interruption::sleep_until(std::chrono::steady_clock::now() + 1h);
        std::_Exit(slept && woken && interruption::signal_name() == "SIGTERM" ? 7 : 1);
      },
      testing::ExitedWithCode(7), "");
}

TEST(Interruption, SecondSignalEndsAtOnce) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        interruption::catch_signals();
        std::raise(SIGTERM);
        std::raise(SIGTERM);  // at once: `timeout` does so
        std::this_thread::sleep_for(300ms);
        std::raise(SIGINT);
        std::_Exit(1);
      },
      testing::KilledBySignal(SIGINT), "");
}

TEST(Interruption, IgnoredSignalsStayIgnored) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        std::signal(SIGHUP, SIG_IGN);
        interruption::catch_signals();
        std::raise(SIGHUP);
        std::_Exit(interruption::signal() == 0 ? 7 : 1);
      },
      testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace ydd
