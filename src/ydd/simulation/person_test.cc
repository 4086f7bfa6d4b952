// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/person.h"

#include <gtest/gtest.h>

#include "ydd/simulation/people.h"

namespace ydd::sim {
namespace {

TEST(Person, StandsOnTheFloor) {
  const PersonShape shape;
  PersonPose pose;
  pose.legs[0] = {0.4, 0.1, -0.2};
  pose.legs[1] = {-0.3, 0.5, 0.3};
  const std::vector<SE3> T = place_person(shape, pose);
  const double left = T[kFoot].translation().z();
  const double right = T[kFoot + 1].translation().z();
  EXPECT_NEAR(std::min(left, right), shape.ankle_height, 1e-9);
  EXPECT_GT(T[kHead].translation().z(), 1.2);
  EXPECT_GT(T[kFoot].translation().y(), T[kFoot + 1].translation().y());  // left leg in front
  EXPECT_LT(T[kFoot].translation().x(), 0);
}

TEST(Person, ReachesWithThePalm) {
  const PersonShape shape;
  PersonPose pose;
  pose.lean = 0.15;
  const double hips = standing_hip_height(shape, pose);
  for (int side = 0; side < 2; ++side) {
    const double sign = side == 0 ? -1 : 1;
    const Eigen::Vector3d target(0.22 * sign, 0.35, 1.15);
    pose.arms[side] = reach(shape, chest_in_person(shape, pose, hips), side, target);
    const std::vector<SE3> T = place_person(shape, pose);
    const Eigen::Vector3d palm = T[kHand + side] * Eigen::Vector3d(0, 0, -shape.palm);
    EXPECT_LT((palm - target).norm(), 0.02);
    EXPECT_GT(pose.arms[side].elbow, 0);  // elbows bend one way
  }
}

TEST(Person, PointsAtWhatIsOutOfReach) {
  const PersonShape shape;
  const PersonPose pose;
  const SE3 chest = chest_in_person(shape, pose, 0.9);
  const ArmPose arm = reach(shape, chest, 1, {0.2, 3.0, 1.3});
  EXPECT_LT(arm.elbow, 0.35);
  EXPECT_NEAR(arm.shoulder, 1.5, 0.3);
}

TEST(Cast, IsAsTheOptionsSay) {
  WorldOptions options;
  Cast cast = choose_cast(options);
  EXPECT_EQ(cast.walkers + cast.sitters, 0);
  EXPECT_FALSE(cast.fan_turns);
  options.people = 3;
  cast = choose_cast(options);
  EXPECT_EQ(cast.walkers, 2);
  EXPECT_EQ(cast.sitters, 1);
  EXPECT_TRUE(cast.pushed_chair);
  options = {};
  options.busy = true;
  cast = choose_cast(options);
  EXPECT_EQ(cast.walkers, 3);
  EXPECT_TRUE(cast.close);
}

}  // namespace
}  // namespace ydd::sim
