// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/published.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(Published, IsNullBeforeTheFirstSet) {
  const Published<int> published;
  EXPECT_EQ(published.get(), nullptr);
}

TEST(Published, GivesTheNewestAndLeavesOldReadersTheirs) {
  Published<int> published(std::make_shared<const int>(1));
  const auto old = published.get();
  published.set(std::make_shared<const int>(2));
  EXPECT_EQ(*old, 1);
  EXPECT_EQ(*published.get(), 2);
}

TEST(Published, ReleasesTheOldValue) {
  auto first = std::make_shared<const int>(1);
  const std::weak_ptr<const int> watch = first;
  Published<int> published(std::move(first));
  EXPECT_FALSE(watch.expired());
  published.set(nullptr);
  EXPECT_TRUE(watch.expired());
  EXPECT_EQ(published.get(), nullptr);
}

/// A destructor that reads the published value would lock up if the old value died under the lock.
struct Reader {
  const Published<Reader>* home = nullptr;
  int* reads = nullptr;
  ~Reader() {
    if (home && home->get()) ++*reads;
  }
};

TEST(Published, TheOldValueDiesOutsideTheLock) {
  Published<Reader> published;
  int reads = 0;
  auto first = std::make_shared<Reader>();
  first->home = &published;
  first->reads = &reads;
  published.set(std::move(first));
  published.set(std::make_shared<Reader>());
  EXPECT_EQ(reads, 1);
}

TEST(Published, ReadersSeeWholeValuesThatNeverGoBack) {
  struct Pair {
    int a, b;
  };
  Published<Pair> published(std::make_shared<const Pair>(Pair{0, 0}));
  std::atomic<bool> torn = false;
  {
    std::vector<std::jthread> readers;
    for (int r = 0; r < 2; ++r) {
      readers.emplace_back([&] {
        int last = 0;
        while (last < 1000) {
          const auto pair = published.get();
          if (pair->a != pair->b || pair->a < last) torn = true;
          last = pair->a;
          std::this_thread::yield();
        }
      });
    }
    for (int i = 1; i <= 1000; ++i) published.set(std::make_shared<const Pair>(Pair{i, i}));
  }
  EXPECT_FALSE(torn);
}

}  // namespace
}  // namespace ydd
