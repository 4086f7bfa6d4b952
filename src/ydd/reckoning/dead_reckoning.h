// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "ydd/reckoning/inertial_fit.h"
#include "ydd/reckoning/reckoning_options.h"

namespace ydd {

/// How the camera has moved since it last saw where it was, by other senses than its own.
struct ReckonedMotion {
  SE3 T_now_then;          ///< camera frames; without a place only its rotation means something
  bool has_place = false;  ///< false: only the turn is known
  double sigma_m = 0, sigma_rad = 0;  ///< standard deviation of each coordinate
};

/// Adds up the motion sensors of a robot between seen poses: wheels tell the place and the turn, a
/// gyroscope the turn, and an accelerometer the place for some seconds, once gravity, its bias and
/// the speed are known from what was seen before. What was seen teaches the biases all the time.
///
/// Samples come in the order of time, those up to a frame before it; older than a quarter of a
/// minute they are forgotten. One that is not later than the last one is left out.
/// Thread: one. Deterministic.
class DeadReckoning {
 public:
  /// @throws std::logic_error unless `check(options)` is good.
  explicit DeadReckoning(const ReckoningOptions& options);

  void add(const ImuSample& sample);
  void add(const OdometryPose& pose);
  bool has_samples() const { return !imu_.empty() || !odometry_.empty(); }

  /// The pose at `stamp` was seen. `T_camera_last` is the motion since the last call; empty where
  /// it is not known.
  void see(Timestamp stamp, const std::optional<SE3>& T_camera_last);

  /// The motion since the pose was last seen. Nothing when no sensor covers the time.
  std::optional<ReckonedMotion> since_seen(Timestamp now) const;

  void clear();

 private:
  std::optional<SE3> odometry_at(Timestamp stamp) const;
  /// R_now_then of the camera, by the gyroscope.
  std::optional<Eigen::Quaterniond> turned(Timestamp now) const;
  std::optional<ReckonedMotion> by_wheels(Timestamp now) const;
  /// By gravity, bias and speed as they were when the pose was last seen.
  std::optional<ReckonedMotion> by_inertia(Timestamp now) const;
  std::optional<ReckonedMotion> by_gyroscope(Timestamp now) const;
  const std::optional<InertialFit>& fit_at_last() const;
  void add_node(Timestamp stamp);
  void learn_gyro_bias(const Preintegrated& between, const SE3& T_then_now);

  ReckoningOptions options_;
  SE3 T_camera_imu_, T_camera_base_;
  std::deque<ImuSample> imu_;
  std::deque<OdometryPose> odometry_;
  std::optional<Timestamp> seen_;  ///< the last time
  SE3 T_world_camera_;             ///< then, in a world of our own: seen motions, one after another
  std::vector<InertialNode> nodes_;
  std::size_t new_nodes_ = 0;  ///< since the prior was renewed
  InertialPrior prior_;
  Eigen::Vector3d gyro_bias_rad_s_ = Eigen::Vector3d::Zero();
  int gyro_lessons_ = 0;
  mutable std::optional<std::optional<InertialFit>> fit_;  ///< of the last time; empty: not asked
};

}  // namespace ydd
