// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/inertial_factor.h"

#include <Eigen/LU>

#include "ydd/geometry/se3_jacobians.h"

namespace ydd {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix36d = Eigen::Matrix<double, 3, 6>;

/// The IMU at a pose of the camera, and how it turns (on its right) and shifts (in the world) with
/// a left twist of T_camera_world.
struct ImuPose {
  Matrix3d R;
  Vector3d p;
  Matrix36d turn_by_twist = Matrix36d::Zero();
  Matrix36d shift_by_twist;
};

ImuPose imu_pose(const SE3& T_camera_world, const SE3& T_camera_imu) {
  const SE3 T_world_camera = T_camera_world.inverse();
  const SE3 T_world_imu = T_world_camera * T_camera_imu;
  ImuPose pose{T_world_imu.rotation_matrix(), T_world_imu.translation(), Matrix36d::Zero(), {}};
  const Matrix3d R_world_camera = T_world_camera.rotation_matrix();
  pose.turn_by_twist.rightCols<3>() = -T_camera_imu.rotation_matrix().transpose();
  pose.shift_by_twist << -R_world_camera, R_world_camera * skew(T_camera_imu.translation());
  return pose;
}

}  // namespace

Eigen::Matrix<double, 3, 2> axes_across(const Vector3d& gravity_m_s2) {
  const Vector3d down = gravity_m_s2.normalized();
  int least = 0;
  down.cwiseAbs().minCoeff(&least);
  Eigen::Matrix<double, 3, 2> axes;
  axes.col(0) = down.cross(Vector3d::Unit(least)).normalized();
  axes.col(1) = down.cross(axes.col(0));
  return axes;
}

LinkError link_error(const InertialProblem& problem, const InertialLink& link,
                     const SE3& T_from_world, const SE3& T_to_world, const InertialUnknowns& x) {
  using inertial_order::kFrom;
  using inertial_order::kGlobal;
  using inertial_order::kGravity;
  using inertial_order::kSpeedFrom;
  using inertial_order::kSpeedTo;
  using inertial_order::kTo;
  const InertialMeasurement& m = link.measured;
  const Preintegrated sum = m.with_biases(x.gyro_bias_rad_s, x.accel_bias_m_s2);
  const double t = sum.duration_s;
  const ImuPose a = imu_pose(T_from_world, problem.T_camera_imu);
  const ImuPose b = imu_pose(T_to_world, problem.T_camera_imu);
  const Vector3d& v_a = x.speed_m_s[static_cast<std::size_t>(link.from)];
  const Vector3d& v_b = x.speed_m_s[static_cast<std::size_t>(link.to)];
  const Matrix3d R_a_world = a.R.transpose();
  const Vector3d gained = R_a_world * (v_b - v_a - t * x.gravity_m_s2);
  const Vector3d shifted = R_a_world * (b.p - a.p - t * v_a - 0.5 * t * t * x.gravity_m_s2);
  const Matrix3d off = sum.turn.toRotationMatrix().transpose() * R_a_world * b.R;
  const Vector3d turned = so3_log(Eigen::Quaterniond(off));

  LinkError e;
  e.residual << turned, gained - sum.speed_m_s, shifted - sum.shift_m;
  e.jacobian.setZero();
  auto by_turn = e.jacobian.topRows<3>();
  auto by_speed = e.jacobian.middleRows<3>(3);
  auto by_shift = e.jacobian.bottomRows<3>();
  const Matrix3d J = so3_right_jacobian(turned).inverse();
  const Vector3d gyro = x.gyro_bias_rad_s - m.gyro_bias_rad_s;
  by_turn.middleCols<6>(kFrom) = -J * b.R.transpose() * a.R * a.turn_by_twist;
  by_turn.middleCols<6>(kTo) = J * b.turn_by_twist;
  by_turn.middleCols<3>(kGlobal) =
      -J * off.transpose() * so3_right_jacobian(m.turn_by_gyro_bias * gyro) * m.turn_by_gyro_bias;
  by_speed.middleCols<6>(kFrom) = skew(gained) * a.turn_by_twist;
  by_speed.middleCols<3>(kSpeedFrom) = -R_a_world;
  by_speed.middleCols<3>(kSpeedTo) = R_a_world;
  by_speed.middleCols<3>(kGlobal) = -m.speed_by_gyro_bias;
  by_speed.middleCols<3>(kGlobal + 3) = -sum.speed_by_bias;
  by_shift.middleCols<6>(kFrom) = skew(shifted) * a.turn_by_twist - R_a_world * a.shift_by_twist;
  by_shift.middleCols<6>(kTo) = R_a_world * b.shift_by_twist;
  by_shift.middleCols<3>(kSpeedFrom) = -t * R_a_world;
  by_shift.middleCols<3>(kGlobal) = -m.shift_by_gyro_bias;
  by_shift.middleCols<3>(kGlobal + 3) = -sum.shift_by_bias;
  const Eigen::Matrix<double, 3, 2> gravity_by_turn =
      -skew(x.gravity_m_s2) * axes_across(x.gravity_m_s2);
  by_speed.middleCols<2>(kGravity) = -t * R_a_world * gravity_by_turn;
  by_shift.middleCols<2>(kGravity) = -0.5 * t * t * R_a_world * gravity_by_turn;
  return e;
}

}  // namespace ydd
