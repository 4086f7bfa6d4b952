// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/background.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(Background, DoesEverythingInOrderOnAnotherThread) {
  std::vector<int> done;
  std::thread::id where;
  Background<int> background(2, [&](int i) -> Result<void> {
    done.push_back(i);
    where = std::this_thread::get_id();
    return {};
  });
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(background.push(i));
  EXPECT_TRUE(background.finish());
  ASSERT_EQ(done.size(), 50U);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
  EXPECT_NE(where, std::this_thread::get_id());
}

TEST(Background, TellsTheFirstFailureAndDropsTheRest) {
  int calls = 0;
  Background<int> background(8, [&](int i) -> Result<void> {
    ++calls;
    if (i == 1) return Error{"disk full"};
    return {};
  });
  for (int i = 0; i < 5; ++i) (void)background.push(i);
  const auto result = background.finish();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().message, "disk full");
  EXPECT_EQ(calls, 2);
  EXPECT_FALSE(background.finish()) << "still so";
}

TEST(Background, WhatIsThrownIsAFailure) {
  Background<int> background(8, [&](int i) -> Result<void> {
    if (i == 1) throw std::runtime_error("no codec\nfor this");
    return {};
  });
  for (int i = 0; i < 3; ++i) (void)background.push(i);
  const auto result = background.finish();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().message, "internal: no codec for this");
}

TEST(Background, DoesNotWaitWhenItIsAskedNotTo) {
  Channel<int> gate(1);
  Background<int> background(1, [&](int) -> Result<void> {
    gate.pop();
    return {};
  });
  // One may be at work and one may wait; the third finds no room.
  int taken = 0;
  for (int i = 0; i < 3; ++i) taken += background.try_push(i).value() ? 1 : 0;
  EXPECT_LE(taken, 2);
  EXPECT_GE(taken, 1);
  gate.close();
  EXPECT_TRUE(background.finish());
}

}  // namespace
}  // namespace ydd
