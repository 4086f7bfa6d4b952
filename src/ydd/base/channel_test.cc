// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/channel.h"

#include <memory>
#include <numeric>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(Channel, GivesValuesInOrder) {
  Channel<int> channel(3);
  EXPECT_TRUE(channel.push(1));
  EXPECT_TRUE(channel.push(2));
  EXPECT_EQ(channel.size(), 2U);
  EXPECT_EQ(channel.pop(), 1);
  EXPECT_EQ(channel.pop(), 2);
  EXPECT_EQ(channel.try_pop(), std::nullopt);
}

TEST(Channel, RefusesBeyondItsCapacity) {
  Channel<int> channel(2);
  EXPECT_TRUE(channel.try_push(1));
  EXPECT_TRUE(channel.try_push(2));
  EXPECT_FALSE(channel.try_push(3));
  EXPECT_EQ(channel.try_pop(), 1);
  EXPECT_TRUE(channel.try_push(3));
  EXPECT_EQ(channel.size(), 2U);
}

TEST(Channel, ClosedRefusesPushesAndDrains) {
  Channel<int> channel(4);
  EXPECT_TRUE(channel.push(1));
  EXPECT_TRUE(channel.push(2));
  channel.close();
  EXPECT_FALSE(channel.push(3));
  EXPECT_FALSE(channel.try_push(3));
  EXPECT_EQ(channel.pop(), 1);
  EXPECT_EQ(channel.try_pop(), 2);
  EXPECT_EQ(channel.pop(), std::nullopt);
}

TEST(Channel, WaitsNoLongerThanItIsTold) {
  Channel<int> channel(2);
  EXPECT_EQ(channel.pop_within(std::chrono::milliseconds(1)), std::nullopt);
  std::jthread writer([&] { channel.push(7); });
  EXPECT_EQ(channel.pop_within(std::chrono::minutes(1)), 7);
  EXPECT_TRUE(channel.try_push(8));
  channel.close();
  EXPECT_EQ(channel.pop_within(std::chrono::minutes(1)), 8);
  EXPECT_EQ(channel.pop_within(std::chrono::minutes(1)), std::nullopt);
}

TEST(Channel, CloseWakesABlockedPop) {
  Channel<int> channel(1);
  std::optional<int> got = 7;
  std::jthread reader([&] { got = channel.pop(); });
  channel.close();
  reader.join();
  EXPECT_EQ(got, std::nullopt);
}

TEST(Channel, CloseWakesABlockedPush) {
  Channel<int> channel(1);
  ASSERT_TRUE(channel.push(1));
  bool pushed = true;
  std::jthread writer([&] { pushed = channel.push(2); });
  channel.close();
  writer.join();
  EXPECT_FALSE(pushed);
  EXPECT_EQ(channel.pop(), 1);
  EXPECT_EQ(channel.pop(), std::nullopt);
}

TEST(Channel, AStopRequestWakesBothSides) {
  Channel<int> empty(1);
  std::optional<int> got = 7;
  {
    const std::jthread reader([&](std::stop_token stop) { got = empty.pop(std::move(stop)); });
  }
  EXPECT_EQ(got, std::nullopt);

  Channel<int> full(1);
  ASSERT_TRUE(full.push(1));
  bool pushed = true;
  {
    const std::jthread writer(
        [&](std::stop_token stop) { pushed = full.push(2, std::move(stop)); });
  }
  EXPECT_FALSE(pushed);
  EXPECT_EQ(full.size(), 1U);
}

TEST(Channel, CarriesValuesThatOnlyMove) {
  Channel<std::unique_ptr<int>> channel(1);
  EXPECT_TRUE(channel.push(std::make_unique<int>(3)));
  const auto value = channel.pop();
  ASSERT_TRUE(value);
  EXPECT_EQ(**value, 3);
}

TEST(Channel, ManyWritersAndReadersLoseNothing) {
  constexpr int kEach = 500;
  Channel<int> channel(4);
  std::vector<long> sums(3, 0);
  std::vector<int> counts(3, 0);
  {
    std::vector<std::jthread> readers;
    for (int r = 0; r < 3; ++r) {
      readers.emplace_back([&, r] {
        while (const auto value = channel.pop()) {
          sums[r] += *value;
          ++counts[r];
        }
      });
    }
    {
      std::vector<std::jthread> writers;
      for (int w = 0; w < 3; ++w) {
        writers.emplace_back([&channel] {
          for (int i = 1; i <= kEach; ++i) EXPECT_TRUE(channel.push(i));
        });
      }
    }
    channel.close();
  }
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0), 3 * kEach);
  EXPECT_EQ(std::accumulate(sums.begin(), sums.end(), 0L), 3L * kEach * (kEach + 1) / 2);
}

TEST(Channel, TheOldestGivesWayWhereNobodyWaits) {
  Channel<int> channel(2);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(channel.push_over(i));
  EXPECT_EQ(channel.displaced(), 3);
  EXPECT_EQ(channel.try_pop(), 3);
  EXPECT_TRUE(channel.push_over(5));
  EXPECT_EQ(channel.displaced(), 3);
  EXPECT_EQ(channel.try_pop(), 4);
  EXPECT_EQ(channel.try_pop(), 5);
  channel.close();
  EXPECT_FALSE(channel.push_over(6));
}

}  // namespace
}  // namespace ydd
