// SPDX-License-Identifier: Apache-2.0
#include "ydd/geometry/se3_jacobians.h"

#include <random>

#include <gtest/gtest.h>

namespace ydd {
namespace {

constexpr double kStep = 1e-6;

Vector6d random_twist(std::mt19937& random, double angle_rad) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Vector6d twist;
  for (int i = 0; i < 6; ++i) twist[i] = 2.0 * unit(random);
  twist.tail<3>() = angle_rad * twist.tail<3>().normalized();
  return twist;
}

class AtAngle : public testing::TestWithParam<double> {
 protected:
  std::mt19937 random_{5};
};

TEST_P(AtAngle, LeftJacobianMatchesNumericDifferences) {
  for (int trial = 0; trial < 10; ++trial) {
    const Vector6d twist = random_twist(random_, GetParam());
    const SE3 inverse = SE3::exp(twist).inverse();
    Matrix6d numeric;
    for (int axis = 0; axis < 6; ++axis) {
      const Vector6d step = kStep * Vector6d::Unit(axis);
      numeric.col(axis) =
          ((SE3::exp(twist + step) * inverse).log() - (SE3::exp(twist - step) * inverse).log()) /
          (2.0 * kStep);
    }
    EXPECT_LT((numeric - se3_left_jacobian(twist)).norm(), 1e-6);
  }
}

TEST_P(AtAngle, InverseMatchesNumericDifferencesOnBothSides) {
  for (int trial = 0; trial < 10; ++trial) {
    const Vector6d twist = random_twist(random_, GetParam());
    const SE3 T = SE3::exp(twist);
    Matrix6d left;
    Matrix6d right;
    for (int axis = 0; axis < 6; ++axis) {
      const SE3 forth = SE3::exp(kStep * Vector6d::Unit(axis));
      const SE3 back = SE3::exp(-kStep * Vector6d::Unit(axis));
      left.col(axis) = ((forth * T).log() - (back * T).log()) / (2.0 * kStep);
      right.col(axis) = ((T * forth).log() - (T * back).log()) / (2.0 * kStep);
    }
    EXPECT_LT((left - se3_left_jacobian_inverse(twist)).norm(), 1e-6);
    EXPECT_LT((right - se3_left_jacobian_inverse(-twist)).norm(), 1e-6);
    const Matrix6d product = se3_left_jacobian(twist) * se3_left_jacobian_inverse(twist);
    EXPECT_LT((product - Matrix6d::Identity()).norm(), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Se3Jacobians, AtAngle,
                         testing::Values(0.0, 1e-9, 1e-5, 1e-3, 0.0999, 0.1001, 0.5, 1.5, 3.0));

TEST(Se3Jacobians, AdjointMovesATwistAcross) {
  std::mt19937 random(6);
  for (int trial = 0; trial < 10; ++trial) {
    const SE3 T = SE3::exp(random_twist(random, 1.0));
    const Vector6d twist = random_twist(random, 0.5);
    const SE3 difference = (T * SE3::exp(twist)).inverse() * (SE3::exp(adjoint(T) * twist) * T);
    EXPECT_LT(difference.log().norm(), 1e-12);
  }
}

}  // namespace
}  // namespace ydd
