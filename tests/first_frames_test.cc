// SPDX-License-Identifier: Apache-2.0
//
// A camera of five pictures a second that turns before the map is a second old: what was in view
// goes farther between two pictures than tracking looks, and a few points agree by chance.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ydd/studies/simulated_run.h"

namespace ydd::e2e {
namespace {

class FirstFrames : public testing::TestWithParam<int> {};

TEST_P(FirstFrames, AreWhereTheyAre) {
  WorldOptions world;
  world.seed = GetParam();
  world.people = 0;
  world.path = PathKind::room_loop;
  world.depth = DepthModel::kinect;
  world.width_px = 320;
  world.height_px = 240;
  world.fps = 5;
  world.frames = 4;
  world.edge_samples = 1;
  SystemOptions options;
  options.deterministic = true;
  const Result<SimulatedRun> run = run_simulated(Simulator(world), options);
  ASSERT_TRUE(run.ok()) << run.error().message;
  EXPECT_EQ(run->lost_frames(), 0);
  const SimulatedStep& first = run->steps.front();
  for (const SimulatedStep& step : run->steps) {
    const SE3 T_first_camera = first.T_true_camera.inverse() * step.T_true_camera;
    const SE3 T_first_estimated = first.T_world_camera.inverse() * step.T_world_camera;
    EXPECT_LT((T_first_camera.inverse() * T_first_estimated).translation().norm(), 0.03);
  }
}

INSTANTIATE_TEST_SUITE_P(Rooms, FirstFrames, testing::Values(2, 4, 5, 10),
                         [](const auto& test) { return fmt::format("{}", test.param); });

}  // namespace
}  // namespace ydd::e2e
