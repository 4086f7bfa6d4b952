// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ydd/base/timestamp.h"
#include "ydd/geometry/se3.h"
#include "ydd/tracks/sightings.h"
#include "ydd/tracks/track_options.h"

namespace ydd {

/// A person or moving thing in the map's frame, as it is believed to be at the time of a frame.
struct WorldTrack {
  std::int64_t id = 0;     ///< of this one alone, in a run
  std::string class_name;  ///< as detected; kThing: never detected as anything
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();    ///< world: the middle of it
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();  ///< world
  Eigen::Vector3d extent_m = Eigen::Vector3d::Zero();      ///< width, height, depth for the camera
  Eigen::Matrix3d position_covariance_m2 = Eigen::Matrix3d::Identity();  ///< of position_m, world
  /// Of velocity_m_s, world.
  Eigen::Matrix3d velocity_covariance_m2_s2 = Eigen::Matrix3d::Identity();
  double age_s = 0;               ///< since it was first seen
  double unseen_s = 0;            ///< since it was seen last; 0: in this frame
  bool moves = false;             ///< as judged when seen last, arms and all; for the way it goes
                                  ///< ask the velocity
  std::optional<float> log_odds;  ///< that it moves, then; none: nothing was known
};

/// Follows what frames show (find_sightings) in the map's frame: one Kalman filter of constant
/// velocity for each, whose noise is the sensor's (standard deviation with the square of the
/// depth) and what a shape leaves open. One that is not seen coasts for a while, then ends.
///
/// Thread: one. Deterministic.
class WorldTracker {
 public:
  /// Follows nobody yet.
  explicit WorldTracker(const WorldTrackOptions& options) : options_(options) {}

  /// A frame with a pose. Where stamps fall back, no time has passed.
  void see(Timestamp stamp, const SE3& T_world_camera, std::span<const Sighting> sightings);
  /// A frame without a pose that could be trusted: nothing is measured.
  void coast(Timestamp stamp);
  /// The map was corrected: what was at p is at T_new_old * p now.
  void move(const SE3& T_new_old);
  /// Ends all; ids are not given again.
  void clear() { tracks_.clear(); }

  /// Those seen often enough and surely once, by rising id.
  std::vector<WorldTrack> tracks() const;

 private:
  using State = Eigen::Matrix<double, 6, 1>;  ///< position, velocity
  struct Track {
    WorldTrack told;  ///< without what the filter knows
    State x = State::Zero();
    Matrix6d P = Matrix6d::Identity();
    int sightings = 0;
    bool sure = false;  ///< once
    std::int64_t image_track = -1;
  };
  struct Seen;  ///< a sighting in the world

  void advance(Timestamp stamp);
  void end_old();
  std::vector<int> associate_tracks(std::span<const Seen> seen) const;
  static void correct(Track& track, const Seen& seen);
  void begin(const Seen& seen);

  WorldTrackOptions options_;
  std::vector<Track> tracks_;  ///< by rising id
  std::optional<Timestamp> now_;
  std::int64_t next_id_ = 0;
};

}  // namespace ydd
