// SPDX-License-Identifier: Apache-2.0
#include "ydd/geometry/se3.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

namespace ydd {
namespace {

Eigen::Vector3d random_vector(std::mt19937& random, double scale) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double z = unit(random), y = unit(random);
  return scale * Eigen::Vector3d(unit(random), y, z);
}

Vector6d random_twist(std::mt19937& random, double translation, double rotation) {
  Vector6d twist;
  twist << random_vector(random, translation), random_vector(random, rotation);
  return twist;
}

/// The power series of the matrix exponential: slow, but without any formula for rotations.
Eigen::Matrix4d exponential_series(const Vector6d& twist) {
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
  a.topLeftCorner<3, 3>() = skew(twist.tail<3>());
  a.topRightCorner<3, 1>() = twist.head<3>();
  Eigen::Matrix4d sum = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d term = Eigen::Matrix4d::Identity();
  for (int n = 1; n < 60; ++n) {
    term = (term * a / n).eval();
    sum += term;
  }
  return sum;
}

TEST(Se3, DefaultIsTheIdentity) {
  EXPECT_EQ(SE3().matrix(), Eigen::Matrix4d(Eigen::Matrix4d::Identity()));
  EXPECT_DOUBLE_EQ(SE3().angle_rad(), 0.0);
}

TEST(Se3, SkewIsTheCrossProduct) {
  std::mt19937 random(1);
  const Eigen::Vector3d a = random_vector(random, 2.0);
  const Eigen::Vector3d b = random_vector(random, 2.0);
  EXPECT_LT((skew(a) * b - a.cross(b)).norm(), 1e-15);
}

TEST(Se3, ExponentialIsTheMatrixExponential) {
  std::mt19937 random(2);
  for (const double angle : {0.0, 1e-12, 1e-6, 1e-5, 1e-4, 1e-3, 0.1, 1.0, 3.0}) {
    for (int i = 0; i < 20; ++i) {
      Vector6d twist = random_twist(random, 2.0, 1.0);
      twist.tail<3>() = angle * twist.tail<3>().normalized();
      EXPECT_LT((SE3::exp(twist).matrix() - exponential_series(twist)).norm(), 1e-12)
          << "angle " << angle;
    }
  }
}

TEST(Se3, LogarithmUndoesTheExponential) {
  std::mt19937 random(3);
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1.1e-4, 0.01, 1.0, 2.0, 3.1, 3.1415}) {
    for (int i = 0; i < 20; ++i) {
      Vector6d twist = random_twist(random, 2.0, 1.0);
      twist.tail<3>() = angle * twist.tail<3>().normalized();
      EXPECT_LT((SE3::exp(twist).log() - twist).norm(), 1e-9) << "angle " << angle;
    }
  }
}

TEST(Se3, LogarithmOfAHalfTurn) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2) / 3.0;
  const Eigen::Quaterniond half_turn(0.0, axis.x(), axis.y(), axis.z());
  const Eigen::Vector3d w = so3_log(half_turn);
  EXPECT_NEAR(w.norm(), std::numbers::pi, 1e-12);
  EXPECT_LT(so3_exp(w).angularDistance(half_turn), 1e-12);
  EXPECT_NEAR(SE3(half_turn, {0, 0, 0}).angle_rad(), std::numbers::pi, 1e-12);
}

TEST(Se3, BothSignsOfAQuaternionAreOneRotation) {
  std::mt19937 random(4);
  const Eigen::Quaterniond q = so3_exp(random_vector(random, 1.0));
  const Eigen::Quaterniond negative(-q.w(), -q.x(), -q.y(), -q.z());
  EXPECT_LT((so3_log(q) - so3_log(negative)).norm(), 1e-14);
  EXPECT_NEAR(SE3(negative, {0, 0, 0}).angle_rad(), so3_log(q).norm(), 1e-14);
}

TEST(Se3, AngleStaysWithinHalfATurn) {
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitY();
  EXPECT_NEAR(SE3(so3_exp(4.0 * axis), {0, 0, 0}).angle_rad(), 2.0 * std::numbers::pi - 4.0, 1e-12);
  EXPECT_LT((so3_log(so3_exp(4.0 * axis)) - (4.0 - 2.0 * std::numbers::pi) * axis).norm(), 1e-12);
}

TEST(Se3, ComposesLikeMatrices) {
  std::mt19937 random(5);
  for (int i = 0; i < 50; ++i) {
    const SE3 a = SE3::exp(random_twist(random, 3.0, 3.0));
    const SE3 b = SE3::exp(random_twist(random, 3.0, 3.0));
    const Eigen::Vector3d p = random_vector(random, 5.0);
    EXPECT_LT(((a * b).matrix() - a.matrix() * b.matrix()).norm(), 1e-12);
    EXPECT_LT((a.inverse().matrix() - a.matrix().inverse()).norm(), 1e-12);
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
    EXPECT_LT((a * p - (a.matrix() * p.homogeneous()).head<3>()).norm(), 1e-12);
    EXPECT_LT((a * a.inverse()).log().norm(), 1e-12);
  }
}

TEST(Se3, MapsFromTheSecondFrameToTheFirst) {
  // The camera stands at (1, 2, 3) and looks along world x: its z axis is world x.
  Eigen::Matrix3d R_world_camera;
  R_world_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const SE3 T_world_camera(R_world_camera, {1, 2, 3});
  EXPECT_LT((T_world_camera * Eigen::Vector3d(0, 0, 5) - Eigen::Vector3d(6, 2, 3)).norm(), 1e-12);
  EXPECT_LT((T_world_camera.inverse() * Eigen::Vector3d(6, 2, 3) - Eigen::Vector3d(0, 0, 5)).norm(),
            1e-12);
}

TEST(Se3, NormalisesItsRotation) {
  const SE3 T(Eigen::Quaterniond(2, 0, 0, 2), {1, 0, 0});
  EXPECT_NEAR(T.rotation().norm(), 1.0, 1e-15);
  EXPECT_LT((T.rotation_matrix() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(),
            1e-12);
}

TEST(Se3, ManyProductsStayRigid) {
  std::mt19937 random(6);
  SE3 T;
  for (int i = 0; i < 20000; ++i) T = SE3::exp(random_twist(random, 0.1, 0.5)) * T;
  const Eigen::Matrix3d R = T.rotation_matrix();
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-13);
}

TEST(Se3, StoredNumbersComeBackBitByBit) {
  std::mt19937 random(7);
  for (int i = 0; i < 1000; ++i) {
    const SE3 T = SE3::exp(random_twist(random, 3.0, 2.0));
    const SE3 again = SE3::from_stored(T.rotation(), T.translation());
    EXPECT_EQ(again.rotation().coeffs(), T.rotation().coeffs());
    EXPECT_EQ(again.translation(), T.translation());
  }
  EXPECT_THROW(SE3::from_stored({1, 1, 0, 0}, {0, 0, 0}), std::logic_error);
  EXPECT_THROW(SE3::from_stored({1, 0, 0, 0}, {0, NAN, 0}), std::logic_error);
}

}  // namespace
}  // namespace ydd
