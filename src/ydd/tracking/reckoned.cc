// SPDX-License-Identifier: Apache-2.0
// What the tracker does with the senses of motion that a robot has besides its camera.
#include <algorithm>
#include <cmath>
#include <limits>

#include "ydd/base/log.h"
#include "ydd/tracking/tracker.h"

namespace ydd {
namespace {

constexpr const char* kNothingKnown = "nothing known in view; motion sensors tell the pose";
constexpr double kSteady_s = 0.12;  // for so long a steady speed tells the place
// A pose that is found again may be off from the reckoned one by this and five sigma.
constexpr double kSlack_m = 0.15, kSlack_rad = 0.1, kSigmas = 5.0;

}  // namespace

SE3 Tracker::predicted_motion(const TrackedFrame& frame) const {
  const std::optional<ReckonedMotion>& reckoned = frame.reckoned;
  if (reckoned && reckoned->has_place) return reckoned->T_now_then;
  SE3 steady;
  if (T_camera_last_) {
    steady = *T_camera_last_;
    const double interval_s = seconds_between(last_->stamp, frame.stamp);
    if (motion_interval_s_ > 0 && interval_s > 0) {
      // Frames that were dropped make it longer; nobody keeps a speed for long.
      constexpr double kLongest = 4.0;
      const double intervals = std::min(kLongest, interval_s / motion_interval_s_);
      steady = SE3::exp(intervals * T_camera_last_->log());
    }
  }
  if (!reckoned) return steady;
  const Eigen::Quaterniond& R = reckoned->T_now_then.rotation();
  return {R, -(R * steady.inverse().translation())};
}

/// The frame's motion, for those that follow it.
void Tracker::take_motion(const TrackedFrame& frame, TrackResult& result) {
  const bool consecutive = state_ == TrackingState::tracking;
  T_camera_last_ = consecutive
                       ? std::optional(frame.T_camera_world * last_->T_camera_world.inverse())
                       : std::nullopt;
  motion_interval_s_ = consecutive ? seconds_between(last_->stamp, frame.stamp) : 0;
  result.T_camera_seen = result.T_camera_last = T_camera_last_;
  if (T_camera_last_ && T_reckoned_last_) {
    result.T_camera_last = *T_camera_last_ * T_reckoned_last_->inverse();
  }
  if (T_reckoned_last_) found_again_ = frame.stamp;
  T_reckoned_last_.reset();
  unknown_since_.reset();
}

/// Where a blind camera is found again, few points are known at first: too few to judge depth by.
bool Tracker::is_just_found(const TrackedFrame& frame) const {
  constexpr double kToLookAround_s = 0.5;
  if (T_reckoned_last_) return true;
  return found_again_ && seconds_between(*found_again_, frame.stamp) < kToLookAround_s;
}

bool Tracker::shows_enough(const TrackedFrame& frame) const {
  const Features& f = frame.features();
  const auto with_depth =
      std::count_if(f.depth_m.begin(), f.depth_m.end(), [](float depth_m) { return depth_m > 0; });
  return with_depth >= options_.min_initial_points;
}

/// Whether it stands where only the senses of motion have brought it.
bool Tracker::is_reckoned(const TrackedFrame& frame) const {
  return T_reckoned_last_ && frame.reckoned && frame.reckoned->has_place;
}

bool Tracker::is_where_reckoned(const TrackedFrame& frame) const {
  if (!is_reckoned(frame)) return true;
  const ReckonedMotion& reckoned = *frame.reckoned;
  const SE3 off = frame.T_camera_world * (reckoned.T_now_then * last_->T_camera_world).inverse();
  return off.translation().norm() < kSlack_m + kSigmas * reckoned.sigma_m &&
         off.angle_rad() < kSlack_rad + kSigmas * reckoned.sigma_rad;
}

/// Whether it sees what is farther away than the surfaces that it must see where it is reckoned.
/// People and darkness hide them, but do not do that: the camera has been carried elsewhere.
bool Tracker::looks_through_the_map(const TrackedFrame& frame, const Atlas& atlas) const {
  constexpr float kAround_px = 12.0F;
  constexpr double kTolerance_m = 0.15, kToleranceShare = 0.05, kShare = 0.2;
  constexpr int kLeast = 10, kAllOctaves = 32;
  const Features& f = frame.features();
  int judged = 0, through = 0;
  std::vector<int> around;
  for (const MapPointId id : last_->points) {
    const MapPoint* const point = atlas.find(id);
    if (!point) continue;
    const Eigen::Vector3d p_camera = frame.T_camera_world * point->p_world;
    if (p_camera.z() <= 0.1) continue;
    const Eigen::Vector2f px = atlas.camera().project(p_camera).cast<float>();
    frame.grid->query(px.x(), px.y(), kAround_px, 0, kAllOctaves, around);
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const int i : around) {
      const double depth_m = f.depth_m[static_cast<std::size_t>(i)];
      if (depth_m > 0) nearest_m = std::min(nearest_m, depth_m);
    }
    if (!std::isfinite(nearest_m)) continue;
    ++judged;
    if (nearest_m > (1 + kToleranceShare) * p_camera.z() + kTolerance_m) ++through;
  }
  return through >= kLeast && through > kShare * judged;
}

/// Nothing that is known was found: the pose is what the senses of motion say, if they do.
std::optional<TrackResult> Tracker::finish_reckoned(TrackedFrame frame, const Atlas& atlas,
                                                    const TrackResult& failed) {
  if (!frame.reckoned || state_ != TrackingState::tracking) return std::nullopt;
  const double blind_s = seconds_between(last_->stamp, frame.stamp);
  if (!frame.reckoned->has_place && blind_s > kSteady_s) return std::nullopt;
  const SE3 T_now_last = predicted_motion(frame);
  frame.T_camera_world = T_now_last * last_->T_camera_world;
  if (!T_reckoned_last_) {  // seen a moment ago: what should be in view is known
    if (frame.doubt.empty() && looks_through_the_map(frame, atlas)) {
      log::warning("frame {}: the view contradicts the motion sensors: carried elsewhere?",
                   frame.index);
      return std::nullopt;
    }
    log::warning("frame {}: {}", frame.index, kNothingKnown);
  }
  TrackResult result;
  result.times = failed.times;
  result.state = TrackingState::coasting;
  result.doubt = kNothingKnown;
  result.reckoned = frame.reckoned;
  result.reference = last_reference_;
  result.T_reference_camera = T_reference_last_ * T_now_last.inverse();
  result.T_world_camera = frame.T_camera_world.inverse();
  result.T_camera_last = T_reckoned_last_ ? T_now_last * T_reckoned_last_->inverse() : T_now_last;
  result.points.assign(frame.points.size(), MapPointId{});
  T_reckoned_last_ = T_now_last;
  const bool usable = !frame.stale && frame.doubt.empty() && shows_enough(frame);
  if (!usable) unknown_since_.reset();
  if (usable && !unknown_since_) unknown_since_ = frame.stamp;
  const bool for_long = unknown_since_ && seconds_between(*unknown_since_, frame.stamp) >=
                                              options_.map_reckoned_after_s;
  if (for_long && !localization_only_) map_reckoned(std::move(frame), result);
  return result;
}

/// An unknown view joins the map, where the senses of motion say that it is; loops find what they
/// have drifted.
void Tracker::map_reckoned(TrackedFrame frame, TrackResult& result) {
  log::info("frame {}: an unknown view enters the map where it is reckoned", frame.index);
  frame.points.assign(frame.points.size(), MapPointId{});
  result.state = TrackingState::tracking;
  result.doubt.clear();
  result.T_camera_seen = *T_reckoned_last_;
  result.reckoned.reset();
  result.candidate =
      KeyFrameCandidate{frame, last_reference_, result.T_reference_camera, take_views()};
  last_candidate_stamp_ = frame.stamp;
  T_reference_last_ = result.T_reference_camera;
  found_again_ = frame.stamp;
  T_camera_last_.reset();
  T_reckoned_last_.reset();
  unknown_since_.reset();
  last_ = std::move(frame);
}

}  // namespace ydd
