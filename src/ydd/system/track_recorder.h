// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ydd/system/slam_system.h"

namespace ydd {

/// The people and moving things of a frame as one line of JSON without a line break:
///
///     {"frame": 12, "stamp_s": 1.4, "map": 0, "tracks": [{"id": 3, "class": "person",
///      "position_m": [x, y, z], "covariance_m2": [xx, xy, xz, yy, yz, zz],
///      "velocity_m_s": [x, y, z], "extent_m": [width, height, depth], "age_s": 1.2,
///      "unseen_s": 0.0, "moving": true, "log_odds": 2.1}, ...]}
///
/// World frame of that map; `log_odds` is null where nothing is known, `map` where the camera's
/// place was never known. Rounded to what the sensor can tell: a tenth of a millimetre.
struct TracksOfFrame {
  std::int64_t frame = 0;
  Timestamp stamp;
  std::int64_t map = -1;  ///< number of the map (slot of its id); negative: none
  std::vector<WorldTrack> tracks;
};
std::string to_json_line(const TracksOfFrame& frame);

/// `track` where its map is corrected by that.
WorldTrack moved(WorldTrack track, const SE3& T_new_old);

/// Collects the tracks of a run. They are told in the final state of the map, as the trajectory is.
class TrackRecorder {
 public:
  void add(const FrameReport& report);
  /// In the order of frames. A frame without a pose is placed as the one before it.
  std::vector<TracksOfFrame> frames(const Atlas& atlas) const;
  /// One line per frame.
  std::string jsonl(const Atlas& atlas) const;

 private:
  struct Recorded {
    TracksOfFrame frame;
    PlacedFrame place;  ///< without a reference: no pose so far
  };
  std::vector<Recorded> frames_;
};

}  // namespace ydd
