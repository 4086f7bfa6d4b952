// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/track_recorder.h"

#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "ydd/base/json_text.h"

namespace ydd {
namespace {

using TrackJson = nlohmann::ordered_json;

double tenth_mm(double metres) { return std::round(metres * 1e4) / 1e4; }

TrackJson metres(const Eigen::Vector3d& v) {
  return {tenth_mm(v.x()), tenth_mm(v.y()), tenth_mm(v.z())};
}

/// The upper triangle, row by row; square millimetres.
TrackJson symmetric(const Eigen::Matrix3d& m) {
  TrackJson out = TrackJson::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      out.push_back(std::round(m(row, column) * 1e6) / 1e6);
    }
  }
  return out;
}

TrackJson json_of(const WorldTrack& track) {
  return {{"id", track.id},
          {"class", track.class_name},
          {"position_m", metres(track.position_m)},
          {"covariance_m2", symmetric(track.position_covariance_m2)},
          {"velocity_m_s", metres(track.velocity_m_s)},
          {"extent_m", metres(track.extent_m)},
          {"age_s", tenth_mm(track.age_s)},
          {"unseen_s", tenth_mm(track.unseen_s)},
          {"moving", track.moves},
          {"log_odds",
           track.log_odds ? TrackJson(std::round(*track.log_odds * 1e3F) / 1e3) : TrackJson()}};
}

}  // namespace

std::string to_json_line(const TracksOfFrame& frame) {
  TrackJson tracks = TrackJson::array();
  for (const WorldTrack& track : frame.tracks) tracks.push_back(json_of(track));
  return json_text(TrackJson{{"frame", frame.frame},
                             {"stamp_s", frame.stamp.seconds()},
                             {"map", frame.map < 0 ? TrackJson() : TrackJson(frame.map)},
                             {"tracks", std::move(tracks)}});
}

WorldTrack moved(WorldTrack track, const SE3& T_new_old) {
  const Eigen::Matrix3d R = T_new_old.rotation_matrix();
  track.position_m = T_new_old * track.position_m;
  track.velocity_m_s = R * track.velocity_m_s;
  track.position_covariance_m2 = R * track.position_covariance_m2 * R.transpose();
  track.velocity_covariance_m2_s2 = R * track.velocity_covariance_m2_s2 * R.transpose();
  return track;
}

void TrackRecorder::add(const FrameReport& report) {
  Recorded recorded{{report.index, report.stamp, -1, report.tracks}, {}};
  const TrackResult& track = report.track;
  if (track.reference.valid()) {
    recorded.place = {track.reference, track.T_reference_camera, track.T_world_camera};
  } else if (!frames_.empty()) {
    recorded.place = frames_.back().place;
  }
  frames_.push_back(std::move(recorded));
}

std::vector<TracksOfFrame> TrackRecorder::frames(const Atlas& atlas) const {
  std::vector<TracksOfFrame> out;
  for (const Recorded& recorded : frames_) {
    out.push_back(recorded.frame);
    if (!recorded.place.reference.valid()) continue;
    const auto correction = correction_since(recorded.place, atlas);
    if (!correction) continue;
    out.back().map = atlas.map_of(recorded.place.reference).slot;
    for (WorldTrack& track : out.back().tracks) track = moved(std::move(track), *correction);
  }
  return out;
}

std::string TrackRecorder::jsonl(const Atlas& atlas) const {
  std::string out;
  for (const TracksOfFrame& frame : frames(atlas)) out += to_json_line(frame) + "\n";
  return out;
}

}  // namespace ydd
