// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/motion_sensors.h"

#include <random>

#include <gtest/gtest.h>

#include "ydd/reckoning/dead_reckoning.h"
#include "ydd/simulation/simulator.h"

namespace ydd {
namespace {

/// How far off dead reckoning is after `blind_s`, having seen the path until then.
double drift_m(const Simulator& simulator, const MotionSamples& samples, int last_seen,
               double blind_s, double off_m) {
  DeadReckoning reckoning(simulated_mounting());
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::size_t imu = 0;
  for (const OdometryPose& pose : samples.odometry) reckoning.add(pose);
  SE3 T_world_last;
  for (int i = 0; i <= last_seen; ++i) {
    for (; imu < samples.imu.size() && samples.imu[imu].stamp <= simulator.stamp(i); ++imu) {
      reckoning.add(samples.imu[imu]);
    }
    const double x = normal(random), y = normal(random), z = normal(random);
    const SE3 T_world_camera =
        simulator.pose(i) * SE3(Eigen::Quaterniond::Identity(), off_m * Eigen::Vector3d(x, y, z));
    reckoning.see(simulator.stamp(i),
                  i == 0 ? std::nullopt : std::optional(T_world_camera.inverse() * T_world_last));
    T_world_last = T_world_camera;
  }
  for (; imu < samples.imu.size(); ++imu) reckoning.add(samples.imu[imu]);
  const int now = last_seen + static_cast<int>(blind_s * 30);
  const auto motion = reckoning.since_seen(simulator.stamp(now));
  if (!motion || !motion->has_place) return 1e9;
  const SE3 truth = simulator.pose(now).inverse() * simulator.pose(last_seen);
  return (motion->T_now_then * truth.inverse()).translation().norm();
}

WorldOptions small_world(PathKind path) {
  WorldOptions world;
  world.width_px = 64;
  world.height_px = 48;
  world.frames = 420;
  world.path = path;
  world.seed = 3;
  return world;
}

MotionSamples imu_alone(const Simulator& simulator) {
  MotionSamples samples = simulator.motion_samples();
  samples.odometry.clear();
  return samples;
}

TEST(MotionSensors, AnIdealImuTellsThePath) {
  for (const PathKind path : {PathKind::halfsphere, PathKind::room_loop}) {
    WorldOptions world = small_world(path);
    world.sensors.imu_noise = 0;
    const Simulator simulator(world);
    EXPECT_LT(drift_m(simulator, imu_alone(simulator), 150, 2.0, 0.0), 0.002);
  }
}

TEST(MotionSensors, ACheapImuTellsItForSeconds) {
  for (const PathKind path : {PathKind::halfsphere, PathKind::room_loop}) {
    const Simulator simulator(small_world(path));
    const double drift_1s_m = drift_m(simulator, imu_alone(simulator), 150, 1.0, 0.004);
    EXPECT_LT(drift_1s_m, 0.05);
    EXPECT_LT(drift_m(simulator, imu_alone(simulator), 150, 2.0, 0.004), 0.15);
    EXPECT_GT(drift_1s_m, 0.001) << "no cheap sensor is that good";
  }
}

TEST(MotionSensors, WheelsTellThePathWithinTheirSlip) {
  WorldOptions world = small_world(PathKind::room_loop);
  world.sensors.imu_hz = 0;
  const Simulator simulator(world);
  const double way_m =
      (simulator.pose(150).translation() - simulator.pose(300).translation()).norm();
  const double slipping_m = drift_m(simulator, simulator.motion_samples(), 150, 5.0, 0.0);
  EXPECT_LT(slipping_m, 0.1 * way_m);
  world.sensors.odometry_slip = 0;
  const Simulator ideal(world);
  const double ideal_m = drift_m(ideal, ideal.motion_samples(), 150, 5.0, 0.0);
  EXPECT_LT(ideal_m, 0.01);
  EXPECT_LT(ideal_m, slipping_m);
}

TEST(MotionSensors, TheSameSeedGivesTheSameSamples) {
  WorldOptions world = small_world(PathKind::xyz);
  const MotionSamples a = Simulator(world).motion_samples(), b = Simulator(world).motion_samples();
  world.seed = 4;
  const MotionSamples other = Simulator(world).motion_samples();
  ASSERT_FALSE(a.imu.empty());
  ASSERT_FALSE(a.odometry.empty());
  EXPECT_EQ(a.imu[77].accel_m_s2, b.imu[77].accel_m_s2);
  EXPECT_NE(a.imu[77].accel_m_s2, other.imu[77].accel_m_s2);
  EXPECT_EQ(a.odometry.back().T_odom_base.translation(),
            b.odometry.back().T_odom_base.translation());
}

}  // namespace
}  // namespace ydd
