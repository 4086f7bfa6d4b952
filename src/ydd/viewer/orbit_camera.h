// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace ydd {

/// The eye of a 3-D view: it looks at a target from a distance, and a mouse turns it round. World
/// frame as docs/conventions.md has it (the first camera's: x right, y down, z forward); which way
/// is up is told. Matrices are OpenGL's (eye looks along -z, clip space -1..1).
class OrbitCamera {
 public:
  /// Turns by a drag of so many pixels; half a turn for 600.
  void orbit(double dx_px, double dy_px);
  /// Moves the target so that what was under the mouse stays under it; `height_px` is that of the
  /// view.
  void pan(double dx_px, double dy_px, double height_px);
  /// Positive steps come nearer, by a tenth each.
  void zoom(double steps);

  void look_at(const Eigen::Vector3d& target) { target_ = target; }
  /// Comes closer to a target and an upright, exponentially: after `kSettle_s` a third of the way
  /// is left.
  void approach(const Eigen::Vector3d& target, const Eigen::Vector3d& up, double elapsed_s);
  void approach_distance(double distance_m, double elapsed_s);
  void set_up(const Eigen::Vector3d& up);
  void set_angles(double yaw_rad, double pitch_rad);
  void set_distance(double distance_m);
  /// Sees a ball whole, without changing direction.
  void fit(const Eigen::Vector3d& centre, double radius_m);

  const Eigen::Vector3d& target() const { return target_; }
  double distance_m() const { return distance_m_; }
  double yaw_rad() const { return yaw_rad_; }
  double pitch_rad() const { return pitch_rad_; }
  Eigen::Vector3d eye() const;

  Eigen::Matrix4d T_eye_world() const;
  /// `aspect` is width / height.
  Eigen::Matrix4d projection(double aspect) const;

  static constexpr double kSettle_s = 0.35;
  static constexpr double kFieldOfView_rad = 0.87;  ///< from top to bottom

 private:
  /// Columns: right, up, back, of the eye.
  Eigen::Matrix3d axes() const;

  Eigen::Vector3d target_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d up_{0, -1, 0};
  double yaw_rad_ = 0;      ///< 0: looks along world z; positive: eye moves to the left
  double pitch_rad_ = 0.6;  ///< of the eye above the target's horizon
  double distance_m_ = 3.0;
};

}  // namespace ydd
