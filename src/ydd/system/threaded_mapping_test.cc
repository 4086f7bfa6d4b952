// SPDX-License-Identifier: Apache-2.0
#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <system_error>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/system/second_visit_testing.h"

namespace ydd {
namespace {

using testing::IsEmpty;
using testing_world::candidate_of;
using testing_world::look;
using testing_world::SecondVisit;
using testing_world::View;

using MakeRunner = std::unique_ptr<MappingRunner> (*)(Mapper, const LoopOptions&);

std::unique_ptr<MappingRunner> runner_for(MakeRunner make, SecondVisit& visit) {
  return make(visit.take_mapper(), testing_world::quick_options());
}

class LoopRunner : public testing::TestWithParam<MakeRunner> {};
INSTANTIATE_TEST_SUITE_P(Both, LoopRunner,
                         testing::Values(make_inline_mapping, make_threaded_mapping),
                         [](const auto& test) {
                           return std::string(test.index == 0 ? "Inline" : "Threaded");
                         });

TEST_P(LoopRunner, ClosesALoopAndAdjustsTheWholeMap) {
  SecondVisit visit;
  const auto runner = runner_for(GetParam(), visit);
  const double before_m = visit.error_m(*runner->atlas());
  ASSERT_TRUE(visit.submit_next(*runner).value());
  ASSERT_TRUE(runner->finish(Ending::complete));
  const MappingReports reports = runner->reports();
  ASSERT_EQ(reports.loops.size(), 1U);
  EXPECT_EQ(reports.loops.front().current_frame, 100);
  EXPECT_EQ(reports.loop_counts.full_bundles, 1);
  EXPECT_EQ(reports.loop_counts.refused, 0);
  EXPECT_EQ(reports.loop_counts.interrupted, 0);
  EXPECT_GT(before_m, 0.1);
  // All of the drift is in one edge of the graph: the first loop takes a part of it, more the rest.
  EXPECT_LT(visit.error_m(*runner->atlas()), 0.7 * before_m);
  EXPECT_THAT(runner->atlas()->check_consistency(), IsEmpty());
}

TEST_P(LoopRunner, EveryLoopHasItsBundleHoweverMuchThereIsToDo) {
  SecondVisit visit;
  const auto runner = runner_for(GetParam(), visit);
  const double before_m = visit.error_m(*runner->atlas());
  int taken = 0;
  for (int i = 0; i < 30; ++i) taken += visit.submit_next(*runner).value() ? 1 : 0;
  ASSERT_TRUE(runner->finish(Ending::complete));
  const MappingReports reports = runner->reports();
  const LoopCounts& counts = reports.loop_counts;
  EXPECT_EQ(reports.keyframes.size(), static_cast<std::size_t>(taken));
  ASSERT_GE(reports.loops.size(), 1U);
  EXPECT_EQ(static_cast<std::size_t>(counts.full_bundles + counts.full_bundles_merged),
            reports.loops.size());
  EXPECT_GE(counts.full_bundles, 1);
  EXPECT_EQ(counts.refused, 0);
  // Each loop takes a part of the drift. Threads take as many keyframes as they have time for, and
  // close as many loops: how good the map becomes depends on the machine.
  EXPECT_LT(visit.error_m(*runner->atlas()), taken == 30 ? 0.03 : before_m);
  EXPECT_THAT(runner->atlas()->check_consistency(), IsEmpty());
}

TEST(ThreadedMapping, ClosesLoopsWhileOthersReadTheMap) {
  SecondVisit visit;
  const auto runner = runner_for(make_threaded_mapping, visit);
  for (int i = 0; i < 40; ++i) {
    (void)visit.submit_next(*runner);
    runner->atlas()->points().for_each(
        [](MapPointId, const MapPoint& p) { EXPECT_FALSE(p.observations.empty()); });
  }
  EXPECT_TRUE(runner->finish(Ending::complete));
}

/// What is asked to end at once must not do all the same work: most often the stop comes before the
/// first keyframe has been mapped, let alone a loop been closed and the map adjusted.
TEST(ThreadedMapping, APromptEndInterruptsTheLoopCloser) {
  for (int attempt = 0; attempt < 10; ++attempt) {
    SecondVisit visit;
    const auto runner = runner_for(make_threaded_mapping, visit);
    ASSERT_TRUE(visit.submit_next(*runner).value());
    ASSERT_TRUE(runner->finish(Ending::prompt));
    const MappingReports reports = runner->reports();
    EXPECT_EQ(reports.keyframes.size(), 1U) << "what was taken is in the map";
    EXPECT_THAT(runner->atlas()->check_consistency(), IsEmpty());
    if (reports.loop_counts.full_bundles > 0) continue;
    EXPECT_EQ(reports.loop_counts.interrupted + reports.loop_counts.keyframes_left_out, 1)
        << "what was left is counted";
    return;
  }
  FAIL() << "the full bundle was waited for every time";
}

/// As long as a bundle takes, the next keyframe can close a loop that makes its result worthless.
TEST(ThreadedMapping, ANewerLoopInterruptsTheFullBundle) {
  for (int attempt = 0; attempt < 20; ++attempt) {
    SecondVisit visit;
    LoopOptions options = testing_world::quick_options();
    options.bundle.relative_decrease = 0;  // to the last digit
    options.bundle.robust_iterations = options.bundle.final_iterations = 100;
    const auto runner = make_threaded_mapping(visit.take_mapper(), options);
    const double before_m = visit.error_m(*runner->atlas());
    for (int i = 0; i < 8; ++i) {
      (void)visit.submit_next(*runner);
      while (!runner->idle()) std::this_thread::yield();
    }
    ASSERT_TRUE(runner->finish(Ending::complete));
    const MappingReports reports = runner->reports();
    const LoopCounts& counts = reports.loop_counts;
    EXPECT_EQ(static_cast<std::size_t>(counts.full_bundles + counts.full_bundles_merged),
              reports.loops.size());
    EXPECT_GE(counts.full_bundles, 1) << "the last one is let be";
    EXPECT_EQ(counts.interrupted, 0);
    EXPECT_LT(visit.error_m(*runner->atlas()), before_m);
    EXPECT_THAT(runner->atlas()->check_consistency(), IsEmpty());
    if (counts.full_bundles_begun_anew > 0) return;
  }
  FAIL() << "every bundle was done before the next loop was found";
}

TEST(ThreadedMapping, AFailureReachesWhoeverAsksAndNobodyWaits) {
  SecondVisit visit;
  const auto runner = runner_for(make_threaded_mapping, visit);
  const auto before = runner->atlas();
  const View view = look(testing_world::make_world(100, 1), SE3());
  KeyFrameCandidate candidate = candidate_of(view, 1, {}, {});
  constexpr int kWidth = 140'000;  // half of it is more than a JPEG can have
  candidate.frame.picture = std::make_shared<const PictureSource>(
      PictureSource{{}, DepthImage(kWidth, 2, std::vector<float>(2 * kWidth)), {}});
  const Result<bool> started = runner->submit(candidate);
  ASSERT_FALSE(started.ok());
  EXPECT_THAT(started.error().message, testing::StartsWith("mapping: internal: "));
  EXPECT_FALSE(runner->failure());
  EXPECT_FALSE(runner->submit(candidate).ok());
  EXPECT_FALSE(runner->finish(Ending::complete).ok());
  EXPECT_EQ(runner->atlas(), before) << "the map is what was published last";
}

constexpr std::size_t kStack = std::size_t{64} << 20U;  // no stack of an earlier thread serves

/// Runs `body` in a child whose threads have large stacks, and which may have so much more address
/// space than it has now; gives how it ended. A child that hangs is ended by a signal.
template <class Body>
int status_with_room_for(std::size_t more_bytes, Body body) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(60);
    pthread_attr_t attributes;
    ::pthread_attr_init(&attributes);
    ::pthread_attr_setstacksize(&attributes, kStack);
    ::pthread_setattr_default_np(&attributes);
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    rlimit limit{};
    limit.rlim_cur = limit.rlim_max =
        pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + more_bytes;
    ::setrlimit(RLIMIT_AS, &limit);
    std::_Exit(body());
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(ThreadedMapping, WithoutAThreadToBeHadItFailsInsteadOfHanging) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need the address space";
#endif
  SecondVisit visit;
  // Room for no thread, for one and for two of the three.
  for (const std::size_t room : {kStack / 2, kStack + kStack / 2, 2 * kStack + kStack / 2}) {
    const int status = status_with_room_for(room, [&] {
      try {
        const auto runner = runner_for(make_threaded_mapping, visit);
        return runner->finish(Ending::complete) ? 10 : 11;
      } catch (const std::system_error&) {
        return 12;
      } catch (const std::bad_alloc&) {
        return 13;
      }
    });
    ASSERT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 12) << "room for " << room << " bytes";
  }
}

}  // namespace
}  // namespace ydd
