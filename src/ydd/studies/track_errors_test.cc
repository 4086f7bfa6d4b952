// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/track_errors.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

constexpr int kFrames = 30;

/// Three people, and a run in which nothing was rendered.
class People : public testing::Test {
 protected:
  static WorldOptions world() {
    WorldOptions options;
    options.width_px = 320;
    options.height_px = 240;
    options.people = 3;
    options.frames = kFrames;
    return options;
  }
  static std::vector<SimulatedMover> people_at(const Simulator& simulator, int frame) {
    std::vector<SimulatedMover> people = simulator.movers(frame);
    std::erase_if(people, [](const SimulatedMover& m) { return m.class_name != "person"; });
    return people;
  }

  /// All are seen and told where they are, in the world of the first camera.
  SimulatedRun perfect() const {
    SimulatedRun run;
    const SE3 T_world_true = simulator_.pose(0).inverse();
    for (int i = 0; i < kFrames; ++i) {
      SimulatedStep step;
      step.state = TrackingState::tracking;
      step.T_true_camera = simulator_.pose(i);
      step.T_world_camera = T_world_true * step.T_true_camera;
      for (const SimulatedMover& person : people_at(simulator_, i)) {
        WorldTrack track;
        track.id = 10 + person.id;
        track.class_name = "person";
        track.position_m = T_world_true * person.middle_m;
        track.velocity_m_s = T_world_true.rotation() * person.velocity_m_s;
        track.position_covariance_m2 = 0.0025 * Eigen::Matrix3d::Identity();
        track.age_s = 2;
        step.tracks.push_back(track);
        step.visible.push_back({"person", person.name, person.id, true, true, {}, 5000});
      }
      run.steps.push_back(step);
    }
    return run;
  }

  const Simulator simulator_{world()};
};

TEST_F(People, WhereTheyAreIsNoError) {
  const TrackErrors errors = track_errors(perfect(), simulator_);
  EXPECT_EQ(errors.wanted, 3 * kFrames);
  EXPECT_EQ(errors.found, errors.wanted);
  EXPECT_EQ(errors.told, errors.wanted);
  EXPECT_EQ(errors.false_ones, 0);
  EXPECT_EQ(errors.switches, 0);
  EXPECT_EQ(errors.within, errors.wanted);
  for (const double m : errors.across_m) EXPECT_LT(m, 1e-9);
  for (const double m_s : errors.velocity_m_s) EXPECT_LT(m_s, 1e-9);
}

TEST_F(People, ErrorsAreCountedWhereTheyAre) {
  SimulatedRun run = perfect();
  const SE3 T_world_true = simulator_.pose(0).inverse();
  for (SimulatedStep& step : run.steps) {
    step.tracks[0].position_m += T_world_true.rotation() * Eigen::Vector3d(0.3, 0, 0.1);
    step.tracks[0].velocity_m_s += T_world_true.rotation() * Eigen::Vector3d(0, 0.5, 0);
  }
  const TrackErrors errors = track_errors(run, simulator_);
  EXPECT_EQ(errors.found, errors.wanted);
  EXPECT_EQ(errors.within, errors.wanted - kFrames) << "0.3 m are six standard deviations";
  EXPECT_NEAR(*std::max_element(errors.across_m.begin(), errors.across_m.end()), 0.3, 1e-9);
  EXPECT_NEAR(*std::max_element(errors.height_m.begin(), errors.height_m.end()), 0.1, 1e-9);
  EXPECT_NEAR(*std::max_element(errors.velocity_m_s.begin(), errors.velocity_m_s.end()), 0.5, 1e-9);
}

TEST_F(People, MissesTracksOfNobodyAndSwitches) {
  SimulatedRun run = perfect();
  for (int i = 0; i < kFrames; ++i) {
    std::vector<WorldTrack>& tracks = run.steps[static_cast<std::size_t>(i)].tracks;
    if (i >= 10) tracks[1].id = 99;                       // one switch
    tracks[2].position_m += Eigen::Vector3d(30, 30, 30);  // of nobody, and a miss
  }
  const TrackErrors errors = track_errors(run, simulator_);
  EXPECT_EQ(errors.found, 2 * kFrames);
  EXPECT_EQ(errors.false_ones, kFrames);
  EXPECT_EQ(errors.switches, 1);
}

}  // namespace
}  // namespace ydd
