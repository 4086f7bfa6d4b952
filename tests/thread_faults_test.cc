// SPDX-License-Identifier: Apache-2.0
//
// Memory that runs out at any moment of the mapper's and the loop closer's work: whatever a thread
// throws, the process goes on, nobody waits for ever, and the map is one that fits together.
// Only what our own code asks for is refused: Ceres ends the process when it cannot note down a
// thread that it has started.
#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>
#include <string>

#include <gtest/gtest.h>

#include "command_line.h"
#include "ydd/system/second_visit_testing.h"

extern "C" const char __executable_start, etext;  // NOLINT: names of the linker

namespace {

constexpr long kNever = std::numeric_limits<long>::max() / 2;
std::atomic<long> allocations = 0;    // of our code, in threads that are not the test's
std::atomic<long> fails_at = kNever;  // the first that fails ...
std::atomic<long> fails_for = 1;      // ... and how many do
thread_local bool is_tester = false;

[[maybe_unused]] bool is_ours(const void* caller) {
  return caller >= &__executable_start && caller < &etext;
}

[[maybe_unused]] void* counted(std::size_t size, const void* caller) {
  if (!is_tester && is_ours(caller)) {
    const long which = allocations.fetch_add(1) - fails_at.load();
    if (which >= 0 && which < fails_for.load()) throw std::bad_alloc();
  }
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}

/// Not inlined: the compiler would see `free` at what its own `new` has given.
[[maybe_unused, gnu::noinline]] void give_back(void* memory) noexcept { std::free(memory); }

}  // namespace

// Sanitizers have operators of their own, which know which belongs to which.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
void* operator new(std::size_t size) { return counted(size, __builtin_return_address(0)); }
void* operator new[](std::size_t size) { return counted(size, __builtin_return_address(0)); }
void operator delete(void* memory) noexcept { give_back(memory); }
void operator delete[](void* memory) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t) noexcept { give_back(memory); }
void operator delete[](void* memory, std::size_t) noexcept { give_back(memory); }
#endif

namespace ydd::e2e {
namespace {

/// Closes a loop while the allocations `first` to `first + count` fail. Empty: it went well.
std::string loop_without_memory(long first, long count) {
  testing_world::SecondVisit visit;
  const auto runner = make_threaded_mapping(visit.take_mapper(), testing_world::quick_options());
  const std::size_t keyframes = runner->atlas()->keyframes().size();
  allocations = 0;
  fails_for = count;
  fails_at = first;
  for (int i = 0; i < 3 && runner->failure(); ++i) (void)visit.submit_next(*runner);
  const Result<void> finished = runner->finish(Ending::complete);
  fails_at = kNever;
  const auto atlas = runner->atlas();
  EXPECT_TRUE(atlas->check_consistency().empty()) << first << ", " << count;
  EXPECT_GT(atlas->keyframes().size(), keyframes / 2);  // some are culled
  return finished ? "" : finished.error().message;
}

TEST(ThreadFaults, WhereverMemoryRunsOutTheMapIsKeptAndTheReasonTold) {
  if (kSanitized) GTEST_SKIP() << "sanitizers have an allocator of their own";
  is_tester = true;
  ASSERT_EQ(loop_without_memory(kNever, 1), "");
  const long all = allocations;
  ASSERT_GT(all, 1000);
  constexpr int kPlaces = 40;
  int told = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const long first = all * i / kPlaces;
    for (const long count : {1L, kNever}) {
      const std::string failure = loop_without_memory(first, count);
      if (failure.empty()) continue;  // a time that was not kept, for example
      ++told;
      EXPECT_NE(failure.find("out of memory"), std::string::npos) << failure;
    }
  }
  EXPECT_GT(told, kPlaces);
}

}  // namespace
}  // namespace ydd::e2e
