// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/system_options.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

TEST(SystemOptions, OfAssignments) {
  const auto options = system_options({"loop.enabled=false", "tracking.match.loose=90"});
  ASSERT_TRUE(options.ok()) << options.error().message;
  EXPECT_FALSE(options->loop.enabled);
  EXPECT_EQ(options->tracking.match.loose, 90);
  EXPECT_FALSE(system_options({"tracking.no_such=1"}).ok());
}

TEST(SystemOptions, PartsAreGivenWhatTheyShare) {
  SystemOptions options;
  options.close_depth_m = 2.5;
  options.tracking.match.loose = 90;
  options.tracking.pose.rounds = 7;
  const SystemOptions resolved = options.resolved();
  EXPECT_EQ(resolved.tracking.close_depth_m, 2.5);
  EXPECT_EQ(resolved.mapping.close_depth_m, 2.5);
  EXPECT_EQ(resolved.mapping.cull.close_depth_m, 2.5);
  EXPECT_EQ(resolved.loop.limits.loose, 90);
  EXPECT_EQ(resolved.loop.pose.rounds, 7);
}

TEST(SystemOptions, EqualRunsNeedBoxesAtFixedFrames) {
  SystemOptions options;
  EXPECT_EQ(options.resolved().detect.latency_frames, 0);
  options.deterministic = true;
  EXPECT_GT(options.resolved().detect.latency_frames, 0);
  options.detect.latency_frames = 5;
  EXPECT_EQ(options.resolved().detect.latency_frames, 5);
}

}  // namespace
}  // namespace ydd
