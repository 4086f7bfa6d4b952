// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <iterator>

#include <ceres/manifold.h>

#include "ydd/geometry/se3.h"

/// How a pose lies in the memory that Ceres moves about. Include in .cc files only.
namespace ydd {

/// A pose as Ceres parameters: quaternion x y z w, then translation in metres.
struct PoseBlock {
  static constexpr int kSize = 7;
  double values[kSize];

  PoseBlock() : PoseBlock(SE3()) {}
  explicit PoseBlock(const SE3& T) {
    Eigen::Map<Eigen::Quaterniond>(static_cast<double*>(values)) = T.rotation();
    Eigen::Map<Eigen::Vector3d>(values + 4) = T.translation();
  }
  static SE3 to_se3(const double* values) {
    return {Eigen::Quaterniond(Eigen::Map<const Eigen::Quaterniond>(values)),
            Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(values + 4))};
  }
  SE3 to_se3() const { return to_se3(static_cast<const double*>(values)); }
};

/// The pose T moved by exp(twist) * T, twist = (translation, rotation).
///
/// Cost functions write their derivatives by the twist into the first six columns of the block and
/// zero into the seventh; with the first six rows of the identity as derivative of Plus, Ceres then
/// works with exactly these. Neither is a derivative by the seven numbers, and nothing asks for
/// one.
class LeftTwistManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return PoseBlock::kSize; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const PoseBlock moved(SE3::exp(Eigen::Map<const Vector6d>(delta)) * PoseBlock::to_se3(x));
    std::copy(std::begin(moved.values), std::end(moved.values), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d> twist(y_minus_x);
    twist = (PoseBlock::to_se3(y) * PoseBlock::to_se3(x).inverse()).log();
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
};

}  // namespace ydd
