// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/mapping_runner.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/map/map_dump.h"
#include "ydd/system/walk_testing.h"

namespace ydd {
namespace {

using testing::IsEmpty;
using testing_world::candidate_of;
using testing_world::look;
using testing_world::position_error_m;
using testing_world::Walker;

using MakeRunner = std::unique_ptr<MappingRunner> (*)(Mapper, const LoopOptions&);

class Runner : public testing::TestWithParam<MakeRunner> {
 protected:
  Walker walker_;
  std::unique_ptr<MappingRunner> runner_ =
      GetParam()(Mapper(walker_.world().camera, walker_.world().scales, {}), LoopOptions());
};

INSTANTIATE_TEST_SUITE_P(Both, Runner, testing::Values(make_inline_mapping, make_threaded_mapping),
                         [](const auto& test) {
                           return std::string(test.index == 0 ? "Inline" : "Threaded");
                         });

TEST_P(Runner, BuildsAConsistentMapWhileTheCameraMoves) {
  std::size_t taken = 0;
  for (int i = 0; i < 90; ++i) {
    const std::shared_ptr<const Atlas> atlas = runner_->atlas();
    ASSERT_NE(atlas, nullptr);
    const TrackResult result = walker_.step(*atlas, runner_->idle());
    ASSERT_EQ(result.state, TrackingState::tracking) << "frame " << i;
    if (i > 0) {
      EXPECT_LT(position_error_m(result.T_world_camera, Walker::path(i)), 0.015) << "frame " << i;
    }
    if (result.candidate && runner_->submit(*result.candidate).value()) ++taken;
    if (i % 10 == 0) {
      ASSERT_THAT(runner_->atlas()->check_consistency(), IsEmpty());
    }
  }
  EXPECT_TRUE(runner_->finish(Ending::complete));
  EXPECT_TRUE(runner_->idle());
  EXPECT_GE(taken, 3U);
  EXPECT_EQ(runner_->reports().keyframes.size(), taken) << "finish() handles what is queued";
  const auto atlas = runner_->atlas();
  EXPECT_THAT(atlas->check_consistency(), IsEmpty());
  for (const MapperReport& report : runner_->reports().keyframes) {
    EXPECT_TRUE(atlas->T_world_keyframe(report.keyframe).has_value());
  }
  MapId map = atlas->at(atlas->newest_keyframe()).map;
  atlas->keyframes().for_each([&](KeyFrameId, const KeyFrame& k) { EXPECT_EQ(k.map, map); });
}

TEST_P(Runner, AMapThatIsStartedIsThereAtOnce) {
  EXPECT_TRUE(runner_->atlas()->keyframes().empty());
  const auto view = look(walker_.world(), SE3());
  ASSERT_TRUE(runner_->submit(candidate_of(view, 0, {}, {})).value());
  EXPECT_EQ(runner_->atlas()->keyframes().size(), 1U);
}

TEST_P(Runner, DrainsWhatWaitsAndThenRefuses) {
  const auto view = look(walker_.world(), SE3());
  ASSERT_TRUE(runner_->submit(candidate_of(view, 0, {}, {})).value());
  const KeyFrameId first = runner_->atlas()->newest_keyframe();
  std::size_t taken = 1;
  for (int i = 1; i <= 10; ++i) {  // faster than they can be mapped
    const SE3 T = Walker::path(4 * i);
    if (runner_->submit(candidate_of(look(walker_.world(), T), i, first, T)).value()) ++taken;
  }
  EXPECT_TRUE(runner_->finish(Ending::complete));
  EXPECT_EQ(runner_->reports().keyframes.size(), taken);
  EXPECT_TRUE(runner_->idle());
  EXPECT_FALSE(runner_->submit(candidate_of(view, 11, first, {})).value());
  EXPECT_FALSE(runner_->submit(candidate_of(view, 12, {}, {})).value());
  EXPECT_TRUE(runner_->finish(Ending::complete));  // a second time does no harm
  EXPECT_EQ(runner_->reports().keyframes.size(), taken);
  EXPECT_THAT(runner_->atlas()->check_consistency(), IsEmpty());
}

TEST_P(Runner, FramesBeforeAStampAreMappedWhenItHasWaitedForThem) {
  const auto view = look(walker_.world(), SE3());
  ASSERT_TRUE(runner_->submit(candidate_of(view, 0, {}, {})).value());
  const KeyFrameId first = runner_->atlas()->newest_keyframe();
  for (int i = 1; i <= 6; ++i) {
    const KeyFrameCandidate candidate =
        candidate_of(look(walker_.world(), Walker::path(4 * i)), i, first, Walker::path(4 * i));
    const Timestamp stamp = candidate.frame.stamp;
    ASSERT_TRUE(runner_->submit(candidate).value()) << "one that is waited for leaves room";
    runner_->wait_for_frames_before({stamp.ns + 1});
    EXPECT_TRUE(runner_->idle());
    runner_->wait_for_frames_before(stamp);  // there are none: it does not wait
  }
  EXPECT_TRUE(runner_->finish(Ending::complete));
  runner_->wait_for_frames_before({std::numeric_limits<std::int64_t>::max()});
}

TEST_P(Runner, MayBeDroppedWithoutFinish) {
  const auto view = look(walker_.world(), SE3());
  ASSERT_TRUE(runner_->submit(candidate_of(view, 0, {}, {})).value());
  const KeyFrameId first = runner_->atlas()->newest_keyframe();
  for (int i = 1; i <= 3; ++i) (void)runner_->submit(candidate_of(view, i, first, {}));
  runner_.reset();
}

TEST(ThreadedMapping, OtherThreadsMayReadTheMapMeanwhile) {
  Walker walker;
  const auto runner = make_threaded_mapping(
      Mapper(walker.world().camera, walker.world().scales, {}), LoopOptions());
  std::atomic<std::int64_t> seen = 0;
  std::jthread reader([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      runner->atlas()->points().for_each([&](MapPointId, const MapPoint& p) {
        EXPECT_FALSE(p.observations.empty());
        ++seen;
      });
      std::this_thread::yield();
    }
  });
  for (int i = 0; i < 20; ++i) {
    const TrackResult result = walker.step(*runner->atlas(), runner->idle());
    if (result.candidate) {
      EXPECT_TRUE(runner->submit(*result.candidate));
    }
  }
  EXPECT_TRUE(runner->finish(Ending::complete));
  while (seen == 0) std::this_thread::yield();  // it may not have had its turn yet
}

}  // namespace
}  // namespace ydd
