// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracks/world_tracker.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace ydd {
namespace {

constexpr double kFirstSpeed_m_s = 1.0;  // standard deviation of what is not known yet
constexpr double kSameImageTrack = 3.0;  // log-likelihood (twice) of being the same in the picture
constexpr double kFarthest_m = 1.0;      // of a sighting from its track
constexpr double kLeastCoast_s = 0.1;
constexpr double kExtentGain = 0.1;  // of a new extent against what is known

bool may_be_one(const std::string& a, const std::string& b) {
  return a == b || a == kThing || b == kThing;
}

/// What is seen of a thing that the border cuts is less than there is.
Eigen::Vector3d merged_extent(const Eigen::Vector3d& known, const Sighting& s) {
  if (s.cut) return known.cwiseMax(s.extent_m);
  return known + kExtentGain * (s.extent_m - known);
}

}  // namespace

struct WorldTracker::Seen {
  const Sighting* sighting = nullptr;
  Eigen::Vector3d p_world;
  Eigen::Matrix3d R_m2;
};

void WorldTracker::see(Timestamp stamp, const SE3& T_world_camera,
                       std::span<const Sighting> sightings) {
  advance(stamp);
  std::vector<Seen> seen;
  const Eigen::Matrix3d R = T_world_camera.rotation_matrix();
  for (const Sighting& s : sightings) {
    seen.push_back({&s, T_world_camera * s.p_camera, R * s.covariance_m2 * R.transpose()});
  }
  const std::vector<int> track_of = associate_tracks(seen);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (track_of[i] >= 0) {
      correct(tracks_[static_cast<std::size_t>(track_of[i])], seen[i]);
    } else {
      begin(seen[i]);
    }
  }
  end_old();
}

void WorldTracker::coast(Timestamp stamp) {
  advance(stamp);
  end_old();
}

void WorldTracker::move(const SE3& T_new_old) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = T_new_old.rotation_matrix();
  for (Track& track : tracks_) {
    track.x = turn * track.x;
    track.x.head<3>() += T_new_old.translation();
    track.P = turn * track.P * turn.transpose();
  }
}

std::vector<WorldTrack> WorldTracker::tracks() const {
  std::vector<WorldTrack> out;
  for (const Track& track : tracks_) {
    if (track.sightings < options_.confirm || !track.sure) continue;
    out.push_back(track.told);
    out.back().position_m = track.x.head<3>();
    out.back().velocity_m_s = track.x.tail<3>();
    out.back().position_covariance_m2 = track.P.topLeftCorner<3, 3>();
    out.back().velocity_covariance_m2_s2 = track.P.bottomRightCorner<3, 3>();
  }
  return out;
}

/// Everything goes on as it went. The acceleration is white noise (Bar-Shalom, Li, Kirubarajan,
/// Estimation with Applications to Tracking and Navigation, 2001, section 6.2.2).
void WorldTracker::advance(Timestamp stamp) {
  const double dt_s = now_ ? std::max(0.0, seconds_between(*now_, stamp)) : 0.0;
  now_ = stamp;
  const double q = options_.speed_change_m_s * options_.speed_change_m_s;
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  Matrix6d F = Matrix6d::Identity(), Q;
  F.topRightCorner<3, 3>() = dt_s * I;
  Q << I * (q * dt_s * dt_s * dt_s / 3), I * (q * dt_s * dt_s / 2), I * (q * dt_s * dt_s / 2),
      I * (q * dt_s);
  for (Track& track : tracks_) {
    track.x = F * track.x;
    track.P = F * track.P * F.transpose() + Q;
    track.told.age_s += dt_s;
    track.told.unseen_s += dt_s;
  }
}

/// Of one that was seen for a moment nobody knows which way it goes.
void WorldTracker::end_old() {
  std::erase_if(tracks_, [&](const Track& track) {
    const double seen_s = track.told.age_s - track.told.unseen_s;
    return track.told.unseen_s > std::min(options_.coast_s, kLeastCoast_s + seen_s);
  });
}

/// For each sighting the index of its track, or -1. The likeliest pairs come first.
std::vector<int> WorldTracker::associate_tracks(std::span<const Seen> seen) const {
  struct Pair {
    double cost;
    std::size_t seen, track;
  };
  std::vector<Pair> pairs;
  for (std::size_t s = 0; s < seen.size(); ++s) {
    const Sighting& sighting = *seen[s].sighting;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      const Track& track = tracks_[t];
      if (!may_be_one(sighting.class_name, track.told.class_name)) continue;
      const Eigen::Vector3d off_m = seen[s].p_world - track.x.head<3>();
      if (off_m.norm() > kFarthest_m) continue;
      const Eigen::Matrix3d S = track.P.topLeftCorner<3, 3>() + seen[s].R_m2;
      const double chi2 = off_m.dot(S.llt().solve(off_m));
      if (chi2 > options_.gate_chi2) continue;
      const bool same = sighting.image_track >= 0 && sighting.image_track == track.image_track;
      // Twice the negative logarithm of the likelihood: who is hardly known explains all a little.
      pairs.push_back({chi2 + std::log(S.determinant()) - (same ? kSameImageTrack : 0), s, t});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.cost < b.cost; });
  std::vector<int> track_of(seen.size(), -1);
  std::vector<bool> taken(tracks_.size(), false);
  for (const Pair& pair : pairs) {
    if (track_of[pair.seen] >= 0 || taken[pair.track]) continue;
    track_of[pair.seen] = static_cast<int>(pair.track);
    taken[pair.track] = true;
  }
  return track_of;
}

void WorldTracker::correct(Track& track, const Seen& seen) {
  const Sighting& s = *seen.sighting;
  const Eigen::Matrix<double, 6, 3> PH = track.P.leftCols<3>();
  const Eigen::Matrix3d S = PH.topRows<3>() + seen.R_m2;
  const Eigen::Matrix<double, 6, 3> K = S.llt().solve(PH.transpose()).transpose();
  track.x += K * (seen.p_world - track.x.head<3>());
  track.P -= K * PH.transpose();
  track.P = 0.5 * (track.P + track.P.transpose()).eval();
  ++track.sightings;
  track.sure = track.sure || s.sure;
  track.image_track = s.image_track;
  if (track.told.class_name == kThing) track.told.class_name = s.class_name;
  track.told.extent_m = merged_extent(track.told.extent_m, s);
  track.told.unseen_s = 0;
  track.told.moves = s.moves;
  track.told.log_odds = s.log_odds;
}

void WorldTracker::begin(const Seen& seen) {
  const Sighting& s = *seen.sighting;
  Track track;
  track.told.id = next_id_++;
  track.told.class_name = s.class_name;
  track.told.extent_m = s.extent_m;
  track.told.moves = s.moves;
  track.told.log_odds = s.log_odds;
  track.x.head<3>() = seen.p_world;
  track.P.topLeftCorner<3, 3>() = seen.R_m2;
  track.P.bottomRightCorner<3, 3>() =
      kFirstSpeed_m_s * kFirstSpeed_m_s * Eigen::Matrix3d::Identity();
  track.sightings = 1;
  track.sure = s.sure;
  track.image_track = s.image_track;
  tracks_.push_back(std::move(track));
}

}  // namespace ydd
