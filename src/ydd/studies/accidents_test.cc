// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/accidents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

constexpr double kFps = 10;

/// A walk of ten seconds along x, estimated without an error, with the map's origin at x = 5 m.
SimulatedRun perfect_run() {
  SimulatedRun run;
  for (int i = 0; i < 100; ++i) {
    SimulatedStep step;
    step.state = TrackingState::tracking;
    const double x_m = 0.01 * i;
    step.T_world_camera = SE3(Eigen::Quaterniond::Identity(), {x_m, 0, 0});
    step.T_true_camera = SE3(Eigen::Quaterniond::Identity(), {5 + x_m, 0, 0});
    run.steps.push_back(step);
  }
  return run;
}

void move_aside(SimulatedStep& step, double y_m) {
  step.T_world_camera = SE3(Eigen::Quaterniond::Identity(), {0, y_m, 0}) * step.T_world_camera;
}

/// The first accident: nothing is seen from 6 to 7 s.
const Accident& covered() { return accidents().front(); }

TEST(Accidents, OneThatIsTrackedAtOnceIsFoundAtOnce) {
  const AccidentOutcome outcome = outcome_of(perfect_run(), covered(), kFps);
  EXPECT_EQ(outcome.frames, 0);
  EXPECT_FALSE(outcome.wrong);
}

TEST(Accidents, FramesThatAreLostOrFarOffDoNotCount) {
  SimulatedRun run = perfect_run();
  for (int i = 60; i < 75; ++i) run.steps[i].state = TrackingState::lost;
  for (int i = 75; i < 80; ++i) move_aside(run.steps[i], 0.2);
  EXPECT_EQ(outcome_of(run, covered(), kFps).frames, 10) << "counted from the end of the accident";
}

TEST(Accidents, OneThatEndsElsewhereIsWrong) {
  SimulatedRun run = perfect_run();
  for (int i = 90; i < 100; ++i) move_aside(run.steps[i], 0.5);
  EXPECT_TRUE(outcome_of(run, covered(), kFps).wrong);
}

TEST(Accidents, OneThatIsNeverFoundAgainHasNoFrames) {
  SimulatedRun run = perfect_run();
  for (int i = 60; i < 100; ++i) run.steps[i].state = TrackingState::lost;
  EXPECT_FALSE(outcome_of(run, covered(), kFps).frames.has_value());
}

TEST(Accidents, AFalseLoopIsWrongAndATrueMergeIsTold) {
  SimulatedRun run = perfect_run();
  CheckedLoop loop;
  loop.report.merged = true;
  run.loops = {loop};
  EXPECT_TRUE(outcome_of(run, covered(), kFps).merged);
  run.loops[0].error_m = 0.3;
  const AccidentOutcome outcome = outcome_of(run, covered(), kFps);
  EXPECT_FALSE(outcome.merged);
  EXPECT_TRUE(outcome.wrong);
}

}  // namespace
}  // namespace ydd
