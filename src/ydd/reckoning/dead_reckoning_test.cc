// SPDX-License-Identifier: Apache-2.0
#include "ydd/reckoning/dead_reckoning.h"

#include <gtest/gtest.h>

#include "ydd/reckoning/carried_sensor_testing.h"

namespace ydd {
namespace {

using carried_sensor::at;
using carried_sensor::Faults;
using carried_sensor::imu;
using carried_sensor::path;

constexpr const char* kMounting = "0.05 -0.02 0.1 0.5 -0.5 0.5 -0.5";
const SE3 kT_camera_sensor = parse_mounting(kMounting, "").value();

ReckoningOptions mounted() {
  ReckoningOptions options;
  options.T_camera_imu = options.T_camera_base = kMounting;
  return options;
}

SE3 camera_at(double t_s) { return path(t_s) * kT_camera_sensor.inverse(); }

/// Sees its way at 30 Hz until `until_s`, each pose off by so much; samples come before frames.
void watch(DeadReckoning& reckoning, const std::vector<ImuSample>& samples, double until_s,
           double off_m = 0, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::optional<SE3> T_world_last;
  std::size_t next = 0;
  for (double t_s = 0.5; t_s <= until_s + 1e-9; t_s += 1.0 / 30) {
    for (; next < samples.size() && samples[next].stamp <= at(t_s); ++next) {
      reckoning.add(samples[next]);
    }
    const double x = normal(random), y = normal(random), z = normal(random);
    const SE3 T_world_camera =
        camera_at(t_s) * SE3(Eigen::Quaterniond::Identity(), off_m * Eigen::Vector3d(x, y, z));
    reckoning.see(at(t_s), T_world_last ? std::optional(T_world_camera.inverse() * *T_world_last)
                                        : std::nullopt);
    T_world_last = T_world_camera;
  }
  for (; next < samples.size(); ++next) reckoning.add(samples[next]);
}

double place_error_m(const ReckonedMotion& motion, double then_s, double now_s) {
  const SE3 truth = camera_at(now_s).inverse() * camera_at(then_s);
  return (motion.T_now_then * truth.inverse()).translation().norm();
}

TEST(DeadReckoning, KnowsNothingWithoutSamplesOrASeenPose) {
  DeadReckoning reckoning(mounted());
  EXPECT_FALSE(reckoning.has_samples());
  EXPECT_FALSE(reckoning.since_seen(at(1.0)));
  reckoning.see(at(1.0), std::nullopt);
  EXPECT_FALSE(reckoning.since_seen(at(1.1)));
  reckoning.add(imu(0.9, 1.0).front());
  EXPECT_FALSE(reckoning.since_seen(at(0.95))) << "before it was seen";
}

TEST(DeadReckoning, FollowsWheelsBetweenTheirReadings) {
  DeadReckoning reckoning(mounted());
  const SE3 T_odom_world(so3_exp({0, 0, 1.0}), {3, 2, 0});  // odometry starts where it likes
  for (double t_s = 0.0; t_s < 4.0; t_s += 0.02)
    reckoning.add(OdometryPose{at(t_s), T_odom_world * path(t_s)});
  reckoning.see(at(1.013), std::nullopt);
  const auto motion = reckoning.since_seen(at(3.507));
  ASSERT_TRUE(motion && motion->has_place);
  EXPECT_LT(place_error_m(*motion, 1.013, 3.507), 1e-3);
  EXPECT_GT(motion->sigma_m, reckoning.since_seen(at(1.1))->sigma_m);
  EXPECT_FALSE(reckoning.since_seen(at(4.6))) << "the wheels have said nothing for half a second";
}

TEST(DeadReckoning, TurnsByTheGyroscopeWhereWheelsSlip) {
  DeadReckoning reckoning(mounted());
  for (const ImuSample& s : imu(0.0, 3.0)) reckoning.add(s);
  for (double t_s = 0.0; t_s < 3.0; t_s += 0.02) {  // wheels that never turn
    reckoning.add(
        OdometryPose{at(t_s), SE3(Eigen::Quaterniond::Identity(), path(t_s).translation())});
  }
  reckoning.see(at(1.0), std::nullopt);
  const auto motion = reckoning.since_seen(at(2.0));
  ASSERT_TRUE(motion.has_value());
  const SE3 truth = camera_at(2.0).inverse() * camera_at(1.0);
  EXPECT_LT(motion->T_now_then.rotation().angularDistance(truth.rotation()), 2e-3);
}

TEST(DeadReckoning, IsBelievedForSoLong) {
  ReckoningOptions options = mounted();
  options.longest_s = 1.0;
  options.longest_imu_s = 0.5;
  DeadReckoning wheels(options);
  for (double t_s = 0.0; t_s < 4.0; t_s += 0.02) wheels.add(OdometryPose{at(t_s), path(t_s)});
  wheels.see(at(1.0), std::nullopt);
  EXPECT_TRUE(wheels.since_seen(at(1.9))->has_place);
  EXPECT_FALSE(wheels.since_seen(at(2.1))->has_place);
  DeadReckoning inertia(options);
  watch(inertia, imu(0.0, 5.0), 3.0);
  EXPECT_TRUE(inertia.since_seen(at(3.4))->has_place);
  EXPECT_FALSE(inertia.since_seen(at(3.6))->has_place) << "of the turn it still knows";
}

TEST(DeadReckoning, GoesOnByInertia) {
  Faults mems;
  mems.gyro_bias_rad_s = {0.005, -0.004, 0.006};
  mems.accel_bias_m_s2 = {0.05, -0.06, 0.04};
  mems.gyro_sigma_rad_s = 0.004;
  mems.accel_sigma_m_s2 = 0.02;
  double worst_1s_m = 0, worst_2s_m = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    mems.seed = seed;
    DeadReckoning reckoning(mounted());
    watch(reckoning, imu(0.0, 12.0, mems), 8.0, 0.004, seed);
    const auto after_1s = reckoning.since_seen(at(9.0)), after_2s = reckoning.since_seen(at(10.0));
    ASSERT_TRUE(after_1s && after_1s->has_place && after_2s && after_2s->has_place);
    worst_1s_m = std::max(worst_1s_m, place_error_m(*after_1s, 8.0, 9.0));
    worst_2s_m = std::max(worst_2s_m, place_error_m(*after_2s, 8.0, 10.0));
    EXPECT_LT(place_error_m(*after_1s, 8.0, 9.0), 4 * after_1s->sigma_m);
    EXPECT_LT(place_error_m(*after_2s, 8.0, 10.0), 4 * after_2s->sigma_m);
  }
  RecordProperty("worst_1s_mm", static_cast<int>(1000 * worst_1s_m));
  RecordProperty("worst_2s_mm", static_cast<int>(1000 * worst_2s_m));
  EXPECT_LT(worst_1s_m, 0.04);
  EXPECT_LT(worst_2s_m, 0.12);
}

TEST(DeadReckoning, StartsAnewWhereTheMotionIsNotKnown) {
  DeadReckoning reckoning(mounted());
  watch(reckoning, imu(0.0, 9.0), 6.0);
  ASSERT_TRUE(reckoning.since_seen(at(6.5))->has_place);
  reckoning.see(at(6.6), std::nullopt);  // found again somewhere
  const auto motion = reckoning.since_seen(at(7.0));
  ASSERT_TRUE(motion.has_value());
  EXPECT_FALSE(motion->has_place) << "neither speed nor gravity are known there";
}

TEST(DeadReckoning, OdometryThatBeginsAnewTellsNothingAcrossTheJump) {
  DeadReckoning reckoning{ReckoningOptions()};
  for (int i = 0; i <= 10; ++i) {
    reckoning.add({at(0.02 * i), SE3(Eigen::Quaterniond::Identity(), {3 + 0.01 * i, 0, 0})});
  }
  reckoning.see(at(0.2), SE3());
  for (int i = 11; i <= 20; ++i) {
    reckoning.add({at(0.02 * i), SE3(Eigen::Quaterniond::Identity(), {0.01 * (i - 11), 0, 0})});
  }
  EXPECT_FALSE(reckoning.since_seen(at(0.3)));
  reckoning.see(at(0.3), SE3());
  const auto motion = reckoning.since_seen(at(0.4));
  ASSERT_TRUE(motion && motion->has_place);
  EXPECT_NEAR(motion->T_now_then.translation().norm(), 0.05, 1e-6);
}

TEST(DeadReckoning, LeavesOutSamplesThatComeTwiceOrLate) {
  DeadReckoning reckoning(mounted());
  const auto samples = imu(0.0, 3.0);
  for (const ImuSample& s : samples) {
    reckoning.add(s);
    ImuSample wrong = samples.front();
    wrong.gyro_rad_s.setConstant(50);
    reckoning.add(wrong);
  }
  reckoning.see(at(1.0), std::nullopt);
  const SE3 truth = camera_at(2.0).inverse() * camera_at(1.0);
  EXPECT_LT(reckoning.since_seen(at(2.0))->T_now_then.rotation().angularDistance(truth.rotation()),
            2e-3);
}

TEST(ReckoningOptions, AMountingIsSevenNumbers) {
  EXPECT_TRUE(parse_mounting(" 1 2 3 0 0 0 1 ", "k"));
  for (const char* wrong :
       {"", "1 2 3", "1 2 3 0 0 0 2", "1 2 3 0 0 0 1 4", "a 2 3 0 0 0 1", "nan 2 3 0 0 0 1"}) {
    const Result<SE3> parsed = parse_mounting(wrong, "reckoning.T_camera_imu");
    ASSERT_FALSE(parsed) << wrong;
    EXPECT_NE(parsed.error().message.find("reckoning.T_camera_imu"), std::string::npos);
  }
}

}  // namespace
}  // namespace ydd
