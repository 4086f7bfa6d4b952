// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <iterator>
#include <stop_token>
#include <utility>

#include <ceres/iteration_callback.h>
#include <ceres/manifold.h>

#include "ydd/geometry/se3.h"

/// What our Ceres problems share. Include in .cc files only.
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

enum class TwistSide {
  left,   ///< exp(twist) * T
  right,  ///< T * exp(twist)
};

/// A pose moved by a twist (translation, rotation) on one side.
///
/// Cost functions write their derivatives by the twist into the first six columns of the block and
/// zero into the seventh; with the first six rows of the identity as derivative of Plus, Ceres then
/// works with exactly these. Neither is a derivative by the seven numbers, and nothing asks for
/// one.
template <TwistSide kTwistSide>
class TwistManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return PoseBlock::kSize; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const SE3 T = PoseBlock::to_se3(x);
    const SE3 step = SE3::exp(Eigen::Map<const Vector6d>(delta));
    const PoseBlock moved(kTwistSide == TwistSide::left ? step * T : T * step);
    std::copy(std::begin(moved.values), std::end(moved.values), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    const SE3 T_y = PoseBlock::to_se3(y);
    const SE3 inverse_x = PoseBlock::to_se3(x).inverse();
    Eigen::Map<Vector6d> twist(y_minus_x);
    twist = (kTwistSide == TwistSide::left ? T_y * inverse_x : inverse_x * T_y).log();
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
};

/// Ends a solve at the next iteration when a stop is requested; Ceres keeps its best state.
class StopCallback : public ceres::IterationCallback {
 public:
  explicit StopCallback(std::stop_token stop) : stop_(std::move(stop)) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return stop_.stop_requested() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  std::stop_token stop_;
};

}  // namespace ydd
