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
