// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracking/doubt.h"

#include <gtest/gtest.h>

namespace ydd {
namespace {

Timestamp at(double seconds) { return {static_cast<std::int64_t>(seconds * 1e9)}; }

TEST(Doubt, EndsOnlyAfterHalfASecondOfBelief) {
  Doubt doubt(DoubtOptions{});
  EXPECT_TRUE(doubt.settle(at(0))) << "there is none";
  EXPECT_TRUE(doubt.raise("why", at(1)));
  EXPECT_FALSE(doubt.raise("why else", at(1.1)));
  EXPECT_EQ(doubt.reason(), "why else");
  EXPECT_FALSE(doubt.settle(at(1.2)));
  EXPECT_FALSE(doubt.raise("again", at(1.6)));
  EXPECT_FALSE(doubt.settle(at(1.7))) << "belief begins anew";
  EXPECT_FALSE(doubt.settle(at(2.1)));
  EXPECT_TRUE(doubt.settle(at(2.3)));
  EXPECT_FALSE(doubt.pending());
  EXPECT_EQ(doubt.reason(), "");
}

TEST(Doubt, IsGivenUpWhenItLasts) {
  DoubtOptions options;
  options.longest_s = 2;
  Doubt doubt(options);
  EXPECT_FALSE(doubt.lasts_too_long(at(100)));
  doubt.raise("why", at(1));
  EXPECT_FALSE(doubt.lasts_too_long(at(3)));
  EXPECT_TRUE(doubt.lasts_too_long(at(3.1)));
}

TEST(Doubt, NoBodyTurnsUpsideDownBetweenTwoFrames) {
  const SE3 turned(so3_exp({0, 0, 3.1}), Eigen::Vector3d::Zero());
  EXPECT_FALSE(is_motion_of_a_body(turned, 0.033, {}));
  EXPECT_TRUE(is_motion_of_a_body(turned, 1.0, {}));
  const SE3 gone(Eigen::Quaterniond::Identity(), {5, 0, 0});
  EXPECT_FALSE(is_motion_of_a_body(gone, 0.033, {}));
  EXPECT_TRUE(is_motion_of_a_body(gone, 1.0, {}));
}

}  // namespace
}  // namespace ydd
