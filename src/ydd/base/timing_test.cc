// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/timing.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(Timing, ClocksDoNotRunBackwards) {
  const std::int64_t wall = wall_clock_ns();
  const std::int64_t cpu = thread_cpu_ns();
  EXPECT_GT(wall, 0);
  EXPECT_GE(cpu, 0);
  EXPECT_GE(wall_clock_ns(), wall);
  EXPECT_GE(thread_cpu_ns(), cpu);
}

TEST(Timing, ATimerWritesOnceInOrder) {
  StageTimes times;
  {
    StageTimer outer(times, "outer");
    StageTimer inner(times, "inner");
    inner.stop();
    inner.stop();
    EXPECT_EQ(times.size(), 1U);
  }
  ASSERT_EQ(times.size(), 2U);
  EXPECT_EQ(times[0].stage, "inner");
  EXPECT_EQ(times[1].stage, "outer");
  EXPECT_GE(times[1].wall_ms, times[0].wall_ms);
  EXPECT_GE(times[0].cpu_ms, 0.0);
}

TEST(Timing, StatisticsOfKnownSeries) {
  const SeriesStatistics s = statistics_of({5, 1, 4, 2, 3});
  EXPECT_EQ(s.count, 5U);
  EXPECT_DOUBLE_EQ(s.mean, 3.0);
  EXPECT_DOUBLE_EQ(s.median, 3.0);
  EXPECT_DOUBLE_EQ(s.min, 1.0);
  EXPECT_DOUBLE_EQ(s.max, 5.0);
  EXPECT_DOUBLE_EQ(s.p05, 1.2);
  EXPECT_DOUBLE_EQ(s.p95, 4.8);
  EXPECT_DOUBLE_EQ(s.p99, 4.96);
  EXPECT_DOUBLE_EQ(statistics_of({1, 2}).median, 1.5);
}

TEST(Timing, StatisticsOfOneAndOfNone) {
  const SeriesStatistics one = statistics_of({7});
  EXPECT_DOUBLE_EQ(one.median, 7.0);
  EXPECT_DOUBLE_EQ(one.p05, 7.0);
  EXPECT_DOUBLE_EQ(one.p99, 7.0);
  const SeriesStatistics none = statistics_of({});
  EXPECT_EQ(none.count, 0U);
  EXPECT_DOUBLE_EQ(none.mean, 0.0);
}

}  // namespace
}  // namespace ydd
