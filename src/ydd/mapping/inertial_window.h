// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ydd/matching/gathered_bundle.h"
#include "ydd/reckoning/motion_samples.h"

namespace ydd {

/// Whether and how an IMU takes part in local bundle adjustment; describe() has the sentences.
struct InertialOptions {
  bool enabled = false;
  int keyframes = 12;
  ImuNoise noise{0.0005, 0.003};               ///< twice what data sheets of cheap ones say
  std::string T_camera_imu = "0 0 0 0 0 0 1";  ///< SystemOptions sets it from `reckoning`
  void describe(OptionTable& table);
};

/// The last keyframes that were made, with what an IMU measured between them, and what is known of
/// its biases, of gravity and of how fast it was at each.
///
/// Samples are kept, not sums: where a keyframe is culled, the next link reaches over it, and every
/// bundle adds up with the newest biases. Keyframes that follow each other by more than ten seconds
/// or in another map begin a new window. Saved maps hold nothing of it: a run that goes on in one
/// learns gravity again, within seconds. While gyroscope and camera tell of other turns (a wrong
/// mounting, a clock that is late) nothing is learnt, and bundles are those of vision alone.
/// Thread: one, the mapper's. Deterministic.
class InertialWindow {
 public:
  /// @throws std::logic_error unless the mounting can be read.
  explicit InertialWindow(const InertialOptions& options);

  /// `keyframe` is the newest. `samples` came since the one before, up to its stamp.
  void enter(const Atlas& atlas, KeyFrameId keyframe, std::span<const ImuSample> samples);
  /// Those that are to be adjusted together with the newest; none until gravity is known.
  std::vector<KeyFrameId> keyframes() const;
  /// The links between keyframes of a bundle. Nothing when there are none.
  std::optional<InertialProblem> problem(const GatheredBundle& bundle) const;
  /// Learns from the solution.
  void take(const GatheredBundle& bundle, const BundleResult& result);

  /// How the keyframes are turned in the world: before the map is moved, for `turned`.
  std::vector<Eigen::Quaterniond> rotations(const Atlas& atlas) const;
  /// The map has been moved: speeds and gravity turn along.
  void turned(const std::vector<Eigen::Quaterniond>& before, const Atlas& atlas);

  bool knows_gravity() const { return learnt_.has_value(); }

 private:
  struct Node {
    KeyFrameId keyframe;
    Timestamp stamp;
    Eigen::Vector3d speed_m_s = Eigen::Vector3d::Zero();  ///< of the IMU, in the world
  };
  struct Learnt {
    Eigen::Vector3d gravity_m_s2;  ///< in the world
    int bundles = 0;               ///< that have taught it
  };

  void forget_before(const Atlas& atlas, const KeyFrame& keyframe);
  std::optional<InertialMeasurement> measured(const Node& from, const Node& to) const;
  void predict_speed(const Atlas& atlas);
  void learn_gravity(const Atlas& atlas);

  InertialOptions options_;
  SE3 T_camera_imu_;
  std::vector<ImuSample> samples_;  ///< from the oldest node on
  std::vector<Node> nodes_;         ///< in the order of time
  std::optional<Learnt> learnt_;
  Eigen::Vector3d gyro_bias_rad_s_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_m_s2_ = Eigen::Vector3d::Zero();
};

}  // namespace ydd
