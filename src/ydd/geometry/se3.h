// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace ydd {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A rigid motion. `T_a_b` maps coordinates in frame b to frame a: `p_a = T_a_b * p_b`.
class SE3 {
 public:
  SE3() : rotation_(Eigen::Quaterniond::Identity()), translation_(Eigen::Vector3d::Zero()) {}
  /// The rotation is normalised. Translation in metres.
  SE3(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation)
      : rotation_(rotation.normalized()), translation_(translation) {}
  /// `rotation` must be orthonormal with determinant +1.
  SE3(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation)
      : SE3(Eigen::Quaterniond(rotation), translation) {}

  /// Takes the numbers as they are, to restore a stored motion bit by bit. @throws std::logic_error
  /// unless the quaternion has unit length within 1e-9 and all is finite.
  static SE3 from_stored(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation);

  const Eigen::Quaterniond& rotation() const { return rotation_; }
  const Eigen::Vector3d& translation() const { return translation_; }
  Eigen::Matrix3d rotation_matrix() const { return rotation_.toRotationMatrix(); }
  Eigen::Matrix4d matrix() const;

  SE3 inverse() const;
  SE3 operator*(const SE3& other) const {
    return {rotation_ * other.rotation_, rotation_ * other.translation_ + translation_};
  }
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation_ * p + translation_; }

  /// Exponential map of a twist (translation part first, then rotation in radians).
  static SE3 exp(const Vector6d& twist);
  /// The twist with `exp(log()) == *this`, rotation angle in [0, pi].
  Vector6d log() const;

  /// Angle of the rotation, radians in [0, pi].
  double angle_rad() const;

 private:
  Eigen::Quaterniond rotation_;
  Eigen::Vector3d translation_;
};

/// Skew-symmetric matrix with `skew(a) * b == a x b`.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);
/// Rotation vector (radians) to rotation.
Eigen::Quaterniond so3_exp(const Eigen::Vector3d& rotation_vector);
/// Rotation to rotation vector (radians), angle in [0, pi].
Eigen::Vector3d so3_log(const Eigen::Quaterniond& rotation);

}  // namespace ydd
