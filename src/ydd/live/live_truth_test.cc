// SPDX-License-Identifier: Apache-2.0
#include "ydd/live/live_truth.h"

#include <cmath>

#include <gtest/gtest.h>

namespace ydd {
namespace {

using Eigen::Vector3d;

/// A bow of `length_m`, 30 poses a second.
StampedPoses bow(double length_m, int count = 60) {
  StampedPoses poses;
  for (int i = 0; i < count; ++i) {
    const double s = length_m * i / (count - 1);
    poses.push_back(
        {{i * 33'333'333LL}, {so3_exp({0, 0.3 * s, 0}), {s, 0.2 * s * s, std::sin(s)}}});
  }
  return poses;
}

StampedPoses moved(const SE3& T_truth_estimate, StampedPoses poses, std::int64_t later_ns = 0) {
  for (StampedPose& pose : poses) {
    pose.T_world_camera = T_truth_estimate * pose.T_world_camera;
    pose.stamp.ns += later_ns;
  }
  return poses;
}

const SE3 kElsewhere(so3_exp({0.4, -1.1, 2.0}), {5, -3, 1});

TEST(LiveTruth, FallsOntoAPerfectEstimate) {
  const StampedPoses estimate = bow(2);
  const LiveTruth truth = align_live_truth(estimate, moved(kElsewhere, estimate, 5'000'000));
  ASSERT_EQ(truth.pairs.size(), estimate.size());
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    EXPECT_EQ(truth.pairs[i].estimate, estimate[i].T_world_camera.translation());
    EXPECT_LT((truth.pairs[i].truth - truth.pairs[i].estimate).norm(), 1e-9);
  }
  EXPECT_LT(truth.rmse_m.value(), 1e-9);
}

TEST(LiveTruth, AShortPathIsAnchoredAtItsFirstPose) {
  const StampedPoses estimate = bow(0.1);
  StampedPoses drifted = moved(kElsewhere, estimate);
  drifted.back().T_world_camera =
      drifted.back().T_world_camera * SE3(Eigen::Quaterniond::Identity(), {0.03, 0, 0});
  const LiveTruth truth = align_live_truth(estimate, drifted);
  EXPECT_LT((truth.pairs.front().truth - truth.pairs.front().estimate).norm(), 1e-9);
  EXPECT_NEAR((truth.pairs.back().truth - truth.pairs.back().estimate).norm(), 0.03, 1e-9);
  EXPECT_NEAR(truth.rmse_m.value(), 0.03 / std::sqrt(60.0), 1e-9);
}

TEST(LiveTruth, OnlyPairsThatBelongTogetherCount) {
  const StampedPoses estimate = bow(2);
  StampedPoses half(estimate.begin(), estimate.begin() + 30);
  EXPECT_EQ(align_live_truth(estimate, half).pairs.size(), 30U);
  EXPECT_EQ(align_live_truth(estimate, moved({}, estimate, 10'000'000'000)).pairs.size(), 0U);
  EXPECT_FALSE(align_live_truth(estimate, {}).rmse_m);
  EXPECT_FALSE(align_live_truth({}, estimate).rmse_m);
}

}  // namespace
}  // namespace ydd
