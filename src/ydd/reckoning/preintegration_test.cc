// SPDX-License-Identifier: Apache-2.0
#include "ydd/reckoning/preintegration.h"

#include <gtest/gtest.h>

#include "ydd/reckoning/carried_sensor_testing.h"

namespace ydd {
namespace {

using carried_sensor::at;
using carried_sensor::imu;
using carried_sensor::path;
using carried_sensor::speed_m_s;

const Eigen::Vector3d kNoBias = Eigen::Vector3d::Zero();
const Eigen::Vector3d kGravity(0, 0, -9.81);

TEST(Preintegration, AddsUpToTheMotion) {
  const auto samples = imu(0.0, 3.0);
  const double from_s = 0.503, until_s = 1.507;  // between samples
  const auto sum = preintegrate(samples, at(from_s), at(until_s), kNoBias, kNoBias);
  ASSERT_TRUE(sum.has_value());
  const double t = until_s - from_s;
  EXPECT_NEAR(sum->duration_s, t, 1e-9);
  const SE3 then = path(from_s), now = path(until_s);
  EXPECT_LT((then.rotation() * sum->turn).angularDistance(now.rotation()), 1e-3);
  const Eigen::Vector3d place = then.translation() + t * speed_m_s(from_s) +
                                0.5 * t * t * kGravity + then.rotation() * sum->shift_m;
  EXPECT_LT((place - now.translation()).norm(), 0.01);
  const Eigen::Vector3d speed = speed_m_s(from_s) + t * kGravity + then.rotation() * sum->speed_m_s;
  EXPECT_LT((speed - speed_m_s(until_s)).norm(), 0.02);
}

TEST(Preintegration, KnowsWhatABiasDoes) {
  const auto samples = imu(0.0, 2.0);
  const Eigen::Vector3d bias(0.1, -0.2, 0.05);
  const auto without = preintegrate(samples, at(0.5), at(1.5), kNoBias, kNoBias);
  const auto with = preintegrate(samples, at(0.5), at(1.5), kNoBias, bias);
  ASSERT_TRUE(without && with);
  EXPECT_LT((without->shift_m + without->shift_by_bias * bias - with->shift_m).norm(), 1e-9);
  EXPECT_LT((without->speed_m_s + without->speed_by_bias * bias - with->speed_m_s).norm(), 1e-9);
  EXPECT_GT((without->shift_m - with->shift_m).norm(), 0.05);
}

TEST(InertialMeasurement, DerivativesByBiasesAreThoseOfDifferences) {
  const auto samples = imu(0.0, 2.0);
  const Eigen::Vector3d gyro(0.01, -0.02, 0.015), accel(0.1, -0.05, 0.2);
  const auto with = [&](const Eigen::Vector3d& g, const Eigen::Vector3d& a) {
    return preintegrate(samples, at(0.503), at(1.507), g, a).value();
  };
  const auto m = measure_inertial(samples, at(0.503), at(1.507), gyro, accel, ImuNoise());
  ASSERT_TRUE(m.has_value());
  const Preintegrated here = with(gyro, accel);
  EXPECT_EQ(m->sum.shift_m, here.shift_m) << "one way to add up";
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(i);
    const Preintegrated up = with(gyro + d, accel), down = with(gyro - d, accel);
    const Eigen::Vector3d turn = so3_log(down.turn.conjugate() * up.turn) / (2 * kStep);
    EXPECT_LT((turn - m->turn_by_gyro_bias.col(i)).norm(), 1e-6);
    EXPECT_LT(((up.speed_m_s - down.speed_m_s) / (2 * kStep) - m->speed_by_gyro_bias.col(i)).norm(),
              1e-5);
    EXPECT_LT(((up.shift_m - down.shift_m) / (2 * kStep) - m->shift_by_gyro_bias.col(i)).norm(),
              1e-5);
  }
  const Eigen::Vector3d more(0.002, 0.003, -0.001);
  const Preintegrated told = m->with_biases(gyro + more, accel + 10 * more);
  const Preintegrated added = with(gyro + more, accel + 10 * more);
  EXPECT_LT(told.turn.angularDistance(added.turn), 1e-5);
  EXPECT_LT((told.speed_m_s - added.speed_m_s).norm(), 1e-4);
  EXPECT_LT((told.shift_m - added.shift_m).norm(), 1e-4);
  EXPECT_GT((here.shift_m - added.shift_m).norm(), 0.01);
}

TEST(InertialMeasurement, CovarianceIsThatOfManyNoisyRuns) {
  const ImuNoise noise{0.002, 0.02};
  constexpr double kRootHz = 14.142135623730951;
  const auto clean = imu(0.0, 1.0);
  const auto m = measure_inertial(clean, at(0.2), at(0.7), kNoBias, kNoBias, noise);
  ASSERT_TRUE(m.has_value());
  Matrix9d spread = Matrix9d::Zero();
  constexpr int kRuns = 400;
  for (unsigned run = 0; run < kRuns; ++run) {
    auto noisy = clean;
    std::mt19937 random(run);
    std::normal_distribution<double> normal;
    for (ImuSample& s : noisy) {
      for (int i = 0; i < 3; ++i) s.gyro_rad_s[i] += kRootHz * noise.gyro_rad_s * normal(random);
      for (int i = 0; i < 3; ++i) s.accel_m_s2[i] += kRootHz * noise.accel_m_s2 * normal(random);
    }
    const auto sum = preintegrate(noisy, at(0.2), at(0.7), kNoBias, kNoBias);
    Eigen::Matrix<double, 9, 1> off;
    off << so3_log(m->sum.turn.conjugate() * sum->turn), sum->speed_m_s - m->sum.speed_m_s,
        sum->shift_m - m->sum.shift_m;
    spread += off * off.transpose() / kRuns;
  }
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(std::sqrt(spread(i, i) / m->covariance(i, i)), 1.0, 0.15) << i;
  }
}

TEST(Preintegration, NeedsSamplesAllTheTime) {
  auto samples = imu(0.0, 2.0);
  EXPECT_FALSE(preintegrate({}, at(0.5), at(1.0), kNoBias, kNoBias));
  EXPECT_FALSE(preintegrate(samples, at(-0.1), at(1.0), kNoBias, kNoBias));
  EXPECT_FALSE(preintegrate(samples, at(1.0), at(2.2), kNoBias, kNoBias));
  EXPECT_TRUE(preintegrate(samples, at(1.0), at(2.05), kNoBias, kNoBias)) << "the last one holds";
  std::erase_if(samples, [](const ImuSample& s) { return s.stamp > at(0.7) && s.stamp < at(0.9); });
  EXPECT_FALSE(preintegrate(samples, at(0.5), at(1.0), kNoBias, kNoBias));
  EXPECT_TRUE(preintegrate(samples, at(1.0), at(1.5), kNoBias, kNoBias));
}

}  // namespace
}  // namespace ydd
