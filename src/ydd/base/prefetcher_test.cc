// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/prefetcher.h"

#include <atomic>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

std::vector<std::size_t> drain(Prefetcher<std::size_t>& prefetcher) {
  std::vector<std::size_t> items;
  while (const auto item = prefetcher.next()) items.push_back(*item);
  return items;
}

std::vector<std::size_t> numbers(std::size_t count) {
  std::vector<std::size_t> expected(count);
  std::iota(expected.begin(), expected.end(), std::size_t{0});
  return expected;
}

TEST(Prefetcher, DeliversAllInOrderWhateverTheWorkers) {
  for (const std::size_t workers : {0U, 1U, 2U, 3U, 8U}) {
    for (const std::size_t depth : {0U, 1U, 5U}) {
      for (const std::size_t count : {0U, 1U, 2U, 100U}) {
        Prefetcher<std::size_t> prefetcher(count, depth, workers, [](std::size_t i) { return i; });
        EXPECT_EQ(drain(prefetcher), numbers(count)) << workers << " workers, depth " << depth;
        EXPECT_EQ(prefetcher.next(), std::nullopt);
      }
    }
  }
}

TEST(Prefetcher, RunsAheadOfTheConsumerButNotTooFar) {
  constexpr std::size_t kDepth = 4;
  constexpr std::size_t kWorkers = 2;
  std::atomic<std::size_t> started = 0;
  Channel<bool> reached(1);
  Prefetcher<std::size_t> prefetcher(1000, kDepth, kWorkers, [&](std::size_t i) {
    if (++started == kDepth) reached.try_push(true);
    return i;
  });
  EXPECT_TRUE(reached.pop());  // without a single call of next()
  for (std::size_t taken = 1; taken <= 50; ++taken) {
    EXPECT_EQ(prefetcher.next(), taken - 1);
    EXPECT_LE(started.load(), taken + kDepth + kWorkers);
  }
}

TEST(Prefetcher, NoWorkersMeansTheCallersThread) {
  std::vector<std::size_t> made;
  Prefetcher<std::size_t> prefetcher(3, 4, 0, [&](std::size_t i) {
    made.push_back(i);
    return i;
  });
  EXPECT_TRUE(made.empty());
  prefetcher.next();
  EXPECT_THAT(made, testing::ElementsAre(0));
}

TEST(Prefetcher, HandsOverWhatCannotBeCopied) {
  Prefetcher<std::unique_ptr<std::string>> prefetcher(
      5, 2, 2, [](std::size_t i) { return std::make_unique<std::string>(std::to_string(i)); });
  prefetcher.next();
  EXPECT_EQ(**prefetcher.next(), "1");
}

TEST(Prefetcher, ExceptionsComeInTheirPlace) {
  for (const std::size_t workers : {0U, 2U}) {
    Prefetcher<std::size_t> prefetcher(4, 2, workers, [](std::size_t i) {
      if (i == 1) throw std::runtime_error("item 1");
      return i;
    });
    EXPECT_EQ(prefetcher.next(), 0U);
    EXPECT_THROW(prefetcher.next(), std::runtime_error);
    EXPECT_EQ(prefetcher.next(), 2U);
    EXPECT_EQ(prefetcher.next(), 3U);
    EXPECT_EQ(prefetcher.next(), std::nullopt);
  }
}

TEST(Prefetcher, RefusesAnEmptyFunction) {
  EXPECT_THROW(Prefetcher<int>(1, 1, 1, {}), std::logic_error);
}

TEST(Prefetcher, EarlyDestructionStopsCleanly) {
  std::atomic<int> inside = 0;
  for (std::size_t round = 0; round < 200; ++round) {
    std::atomic<std::size_t> made = 0;
    {
      Prefetcher<std::vector<int>> prefetcher(100000, 3, 1 + round % 3, [&](std::size_t) {
        ++inside;
        std::vector<int> item(1000, 1);
        ++made;
        --inside;
        return item;
      });
      for (std::size_t taken = 0; taken < round % 7; ++taken) prefetcher.next();
    }
    EXPECT_EQ(inside.load(), 0);  // nobody runs any more
    EXPECT_LT(made.load(), 100U);
  }
}

TEST(Prefetcher, SkippedItemsAreNotComputed) {
  for (const std::size_t workers : {0U, 1U, 3U}) {
    std::atomic<int> computed{0};
    Prefetcher<int> items(1000, 4, workers, [&](std::size_t i) {
      ++computed;
      return static_cast<int>(i);
    });
    EXPECT_EQ(items.next(), 0) << workers;
    items.skip_to(900);
    EXPECT_EQ(items.next(), 900) << workers;
    EXPECT_LT(computed.load(), 100) << workers;
    items.skip_to(5000);
    EXPECT_FALSE(items.next()) << workers;
  }
}

}  // namespace
}  // namespace ydd
