// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/guard.h"

#include <new>
#include <stdexcept>
#include <system_error>

#include <gtest/gtest.h>

namespace ydd {
namespace {

template <class Thrown>
std::string message_of(const Thrown& thrown) {
  const Result<int> result = guarded("mapping", [&]() -> Result<int> { throw thrown; });
  return result ? "none" : result.error().message;
}

TEST(Guarded, GivesWhatTheStepGives) {
  EXPECT_EQ(guarded("here", []() -> Result<int> { return 7; }).value(), 7);
  const Result<int> failed = guarded("here", []() -> Result<int> { return Error{"no"}; });
  EXPECT_EQ(failed.error().message, "no");
}

TEST(Guarded, WhatIsThrownBecomesOneLine) {
  EXPECT_EQ(message_of(std::logic_error("broken")), "mapping: internal: broken");
  EXPECT_EQ(message_of(std::runtime_error("two\nlines\n")), "mapping: internal: two lines");
  EXPECT_EQ(message_of(std::bad_alloc()), "mapping: out of memory");
  EXPECT_EQ(message_of(7), "mapping: internal: something unknown was thrown");
  const std::string refused =
      message_of(std::system_error(std::make_error_code(std::errc::no_such_process)));
  EXPECT_EQ(refused.substr(0, 28), "mapping: the system refused:") << refused;
}

TEST(FirstError, KeepsTheFirst) {
  FirstError failure;
  EXPECT_TRUE(failure.get());
  failure.set({"first"});
  failure.set({"second"});
  EXPECT_TRUE(failure);
  EXPECT_EQ(failure.get().error().message, "first");
}

}  // namespace
}  // namespace ydd
