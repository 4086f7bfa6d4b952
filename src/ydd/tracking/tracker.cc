// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracking/tracker.h"

#include <algorithm>
#include <utility>

#include "ydd/base/log.h"
#include "ydd/place/place_query.h"

namespace ydd {
namespace {

constexpr int kRelocalizationCandidates = 8;
constexpr const char* kDepthContradicts = "depth contradicts the map";

void assign(const PoseFromMatches& pose, TrackedFrame& frame) {
  frame.T_camera_world = pose.T_camera_world;
  for (const PointMatch& m : pose.inliers) {
    frame.points[static_cast<std::size_t>(m.keypoint)] = m.point;
  }
}

/// The map's newest keyframe and those around it, best first.
std::vector<KeyFrameId> recent_keyframes(const Atlas& atlas, KeyFrameId reference) {
  std::vector<KeyFrameId> out;
  const auto add = [&](KeyFrameId id) {
    if (atlas.find(id) && std::find(out.begin(), out.end(), id) == out.end()) out.push_back(id);
  };
  add(reference);
  add(atlas.newest_keyframe());
  if (const KeyFrame* keyframe = atlas.find(reference)) {
    for (const Covisible& c : keyframe->covisible) {
      if (out.size() >= kRelocalizationCandidates) break;
      add(c.keyframe);
    }
  }
  return out;
}

}  // namespace

Tracker::Tracker(const TrackerOptions& options, bool in_known_map)
    : options_(options),
      state_(in_known_map ? TrackingState::lost : TrackingState::initializing),
      depth_watch_(options.doubt),
      doubt_(options.doubt),
      arrival_(!in_known_map) {}

TrackResult Tracker::track(TrackedFrame frame, const Atlas& atlas, bool mapper_idle) {
  frame.points.assign(frame.features().size(), MapPointId{});
  if (state_ == TrackingState::initializing && !adopt_first_keyframe(atlas)) {
    return initialize(std::move(frame));
  }
  refresh_last_frame(atlas);
  TrackResult result;
  if (find_pose(atlas, frame, result)) {
    return conclude(std::move(frame), atlas, std::move(result), mapper_idle);
  }
  // What contradicts the map with its depth may agree with it without.
  if (state_ == TrackingState::tracking && options_.doubt.enabled && arrival_.settled()) {
    TrackedFrame bare = colour_only(frame);
    bare.points.assign(bare.points.size(), MapPointId{});
    if (find_pose(atlas, bare, result) && moves_as_a_body(bare) &&
        !doubt_.lasts_too_long(frame.stamp)) {
      return finish_coasting(std::move(bare), atlas, std::move(result), kDepthContradicts);
    }
  }
  if (std::optional<TrackResult> reckoned = finish_reckoned(frame, atlas, result)) return *reckoned;
  if (doubt_.pending() && !doubt_.lasts_too_long(frame.stamp)) {
    return finish_doubted(std::move(frame), atlas, std::move(result), doubt_.reason());
  }
  return finish_lost(std::move(frame), atlas, std::move(result));
}

bool Tracker::find_pose(const Atlas& atlas, TrackedFrame& frame, TrackResult& result) {
  StageTimer initial_timer(result.times, "initial_pose");
  const std::optional<PoseFromMatches> pose = initial_pose(frame, atlas);
  initial_timer.stop();
  if (!pose) return false;
  result.motion_inliers = static_cast<int>(pose->inliers.size());
  assign(*pose, frame);
  if (!is_where_reckoned(frame)) return false;
  const StageTimer local_timer(result.times, "local_map");
  return track_local_map(atlas, frame, result) && confirm_place(atlas, frame, result);
}

/// Where it was recognised in a place that it was not just in, the place must bear itself out.
bool Tracker::confirm_place(const Atlas& atlas, const TrackedFrame& frame,
                            const TrackResult& result) {
  if (state_ == TrackingState::lost) {
    const std::vector<KeyFrameId> recent = recent_keyframes(atlas, last_reference_);
    const bool elsewhere = !is_reckoned(frame) && std::find(recent.begin(), recent.end(),
                                                            result.reference) == recent.end();
    if (elsewhere || !arrival_.settled()) {
      arrival_.begin(frame.stamp);
      last_candidate_stamp_ = frame.stamp;
    }
  }
  if (arrival_.look(frame.stamp, result.agreement, options_.arrival)) return true;
  log::debug("frame {}: looks less like the place that was recognised than a place does",
             frame.index);
  return false;
}

TrackResult Tracker::conclude(TrackedFrame frame, const Atlas& atlas, TrackResult result,
                              bool mapper_idle) {
  if (!moves_as_a_body(frame)) {
    return finish_doubted(std::move(frame), atlas, std::move(result),
                          "the pose jumps as no body moves");
  }
  const bool contradicts = !is_just_found(frame) && depth_is_doubtful(atlas, frame);
  const bool doubted = contradicts || !frame.doubt.empty();
  if (doubted && !doubt_.lasts_too_long(frame.stamp)) {
    const std::string doubt = frame.doubt.empty() ? kDepthContradicts : frame.doubt;
    return finish_coasting(std::move(frame), atlas, std::move(result), doubt);
  }
  return finish_tracked(std::move(frame), atlas, std::move(result), mapper_idle);
}

TrackResult Tracker::initialize(TrackedFrame frame) {
  TrackResult result;
  if (!shows_enough(frame) || localization_only_) return result;
  frame.T_camera_world = SE3();
  last_ = frame;
  arrival_.settle();
  last_candidate_stamp_ = frame.stamp;
  result.state = TrackingState::tracking;
  result.points = frame.points;
  result.candidate = KeyFrameCandidate{std::move(frame), {}, {}, {}};
  return result;
}

bool Tracker::adopt_first_keyframe(const Atlas& atlas) {
  const KeyFrameId id = atlas.newest_keyframe();
  if (!last_ || !id.valid() || atlas.at(id).shared_features != last_->shared_features) return false;
  last_reference_ = id;
  T_reference_last_ = SE3();
  state_ = TrackingState::tracking;
  log::info("frame {}: map started with {} keypoints", last_->index, last_->features().size());
  return true;
}

void Tracker::refresh_last_frame(const Atlas& atlas) {
  if (!last_) return;  // lost since the start
  // The mapper may have moved the reference, merged points, or made a keyframe of the last frame.
  const KeyFrameId newest = atlas.newest_keyframe();
  const KeyFrame* const keyframe = atlas.find(newest);  // null: not in this part of the map
  if (keyframe && keyframe->shared_features == last_->shared_features) {
    last_->points = keyframe->points;
    last_reference_ = newest;
    T_reference_last_ = SE3();
  }
  if (const std::optional<SE3> T_world_reference = atlas.T_world_keyframe(last_reference_)) {
    const SE3 T_world_last = *T_world_reference * T_reference_last_;
    last_->T_camera_world = T_world_last.inverse();
    // A culled reference can be no fallback and has no neighbours: go on with the one it hangs on.
    // One that is not in this part of the map has a place, and nothing that it hangs on.
    const KeyFrameId kept = atlas.nearest_kept(last_reference_);
    if (kept.valid() && kept != last_reference_) {
      last_reference_ = kept;
      T_reference_last_ = atlas.at(last_reference_).T_world_camera.inverse() * T_world_last;
    }
  }
}

std::optional<PoseFromMatches> Tracker::initial_pose(const TrackedFrame& frame,
                                                     const Atlas& atlas) const {
  if (state_ == TrackingState::lost) return pose_by_relocalization(frame, atlas);
  std::optional<PoseFromMatches> pose = pose_by_motion(frame, atlas);
  if (pose && static_cast<int>(pose->inliers.size()) >= options_.sure_motion_inliers) return pose;
  // A camera that turned out of the search window: few agree, perhaps by chance.
  std::optional<PoseFromMatches> anywhere = pose_by_reference(frame, atlas);
  if (!pose || (anywhere && anywhere->inliers.size() > 2 * pose->inliers.size())) {
    pose = std::move(anywhere);
  }
  return pose ? pose : pose_by_relocalization(frame, atlas);
}

std::optional<PoseFromMatches> Tracker::pose_by_motion(const TrackedFrame& frame,
                                                       const Atlas& atlas) const {
  TrackedFrame predicted = frame;
  predicted.T_camera_world = predicted_motion(frame) * last_->T_camera_world;
  const auto search = [&](double radius_px) {
    return search_last_frame(atlas, *last_, predicted, radius_px, options_.close_depth_m,
                             options_.match);
  };
  std::vector<PointMatch> matches = search(options_.motion_radius_px);
  if (static_cast<int>(matches.size()) < options_.min_motion_matches) {
    matches = search(2.0 * options_.motion_radius_px);
  }
  if (static_cast<int>(matches.size()) < options_.min_motion_inliers) return std::nullopt;
  PoseFromMatches pose = pose_from_matches(atlas.camera(), atlas.scales(), frame.features(),
                                           predicted.T_camera_world, matches, options_.pose);
  if (static_cast<int>(pose.inliers.size()) < options_.min_motion_inliers) return std::nullopt;
  return pose;
}

std::optional<PoseFromMatches> Tracker::pose_by_reference(const TrackedFrame& frame,
                                                          const Atlas& atlas) const {
  if (!atlas.find(last_reference_)) return std::nullopt;
  const std::vector<PointMatch> matches =
      match_keyframe(atlas, last_reference_, frame, 0.7, options_.match);
  if (static_cast<int>(matches.size()) < options_.min_motion_matches) return std::nullopt;
  PoseFromMatches pose = pose_from_matches(atlas.camera(), atlas.scales(), frame.features(),
                                           last_->T_camera_world, matches, options_.pose);
  if (static_cast<int>(pose.inliers.size()) < options_.min_motion_inliers) return std::nullopt;
  return pose;
}

std::vector<KeyFrameId> Tracker::similar_places(const TrackedFrame& frame,
                                                const Atlas& atlas) const {
  constexpr std::size_t kPerPlace = 6;  // keyframes of one place that look much the same
  const BagOfWords words = bag_of_words(builtin_vocabulary(), frame.features().descriptors);
  const auto wanted = static_cast<std::size_t>(options_.place_candidates);
  const auto candidates = query_places(
      atlas, words, [](KeyFrameId) { return true; }, kPerPlace * wanted);
  std::vector<KeyFrameId> out;
  for (const PlaceCandidate& place : distinct_places(atlas, candidates, wanted)) {
    out.push_back(place.keyframe);
  }
  return out;
}

std::optional<PoseFromMatches> Tracker::pose_by_relocalization(const TrackedFrame& frame,
                                                               const Atlas& atlas) const {
  // Where it has just been it may be without further proof; elsewhere the place must be unlike
  // every other one.
  const std::vector<KeyFrameId> recent = recent_keyframes(atlas, last_reference_);
  std::optional<Relocalization> found;
  if (!arrival_.settled()) {  // it has been nowhere yet
    std::vector<KeyFrameId> places = similar_places(frame, atlas);
    places.insert(places.end(), recent.begin(), recent.end());
    found = relocalize_uniquely(atlas, frame, places, options_.relocalization, options_.pose,
                                options_.match);
    return found ? std::optional(PoseFromMatches{found->T_camera_world, found->inliers})
                 : std::nullopt;
  }
  found = relocalize(atlas, frame, recent, options_.relocalization, options_.pose, options_.match);
  if (!found && is_reckoned(frame)) {  // which of two alike places it is, the senses know
    found = relocalize(atlas, frame, similar_places(frame, atlas), options_.relocalization,
                       options_.pose, options_.match);
  } else if (!found) {
    found = relocalize_uniquely(atlas, frame, similar_places(frame, atlas), options_.relocalization,
                                options_.pose, options_.match);
  }
  if (!found) return std::nullopt;
  return PoseFromMatches{found->T_camera_world, found->inliers};
}

bool Tracker::track_local_map(const Atlas& atlas, TrackedFrame& frame, TrackResult& result) {
  std::vector<MapPointId> seen;
  seen.reserve(frame.points.size());
  for (const MapPointId id : frame.points) {
    if (id.valid()) seen.push_back(id);
  }
  const LocalMap local =
      gather_local_map(atlas, seen, last_reference_, options_.max_local_keyframes);
  result.local_points = static_cast<int>(local.points.size());
  const LocalSearch search =
      search_local_map(atlas, local, frame, options_.local_radius_factor, options_.match);
  std::vector<PointMatch> matches;
  matches.reserve(search.matches.size() + seen.size());
  matches.assign(search.matches.begin(), search.matches.end());
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (const MapPoint* point = atlas.find(frame.points[i])) {
      matches.push_back({static_cast<int>(i), point->p_world, frame.points[i], 0, 0});
    }
  }
  const PoseFromMatches pose = pose_from_matches(atlas.camera(), atlas.scales(), frame.features(),
                                                 frame.T_camera_world, matches, options_.pose);
  local_matches_ = std::move(matches);
  result.inliers = static_cast<int>(pose.inliers.size());
  result.agreement = local_matches_.empty() ? 0.0
                                            : static_cast<double>(result.inliers) /
                                                  static_cast<double>(local_matches_.size());
  if (result.inliers < options_.min_local_inliers) return false;
  if (result.agreement < options_.min_agreement) return false;
  frame.points.assign(frame.points.size(), MapPointId{});
  assign(pose, frame);
  count_views(atlas, local, search, frame);
  set_pose(atlas, frame, local, result);
  return true;
}

bool Tracker::contradicted(const Atlas& atlas, const Eigen::Vector3d& p_world,
                           const TrackedFrame& frame) const {
  if (!frame.odds || frame.odds->empty()) return false;
  constexpr double kTolerance_m = 0.04, kGrowth_per_m = 0.008;  // of depth and pose
  const Eigen::Vector3d p_camera = frame.T_camera_world * p_world;
  if (p_camera.z() <= 0) return false;
  const Eigen::Vector2d px = atlas.camera().distort(atlas.camera().project(p_camera));
  const double z_m = p_camera.z();
  return frame.odds->contradicts(static_cast<float>(px.x()), static_cast<float>(px.y()),
                                 static_cast<float>(z_m),
                                 static_cast<float>(kTolerance_m + kGrowth_per_m * z_m * z_m));
}

void Tracker::count_views(const Atlas& atlas, const LocalMap& local, const LocalSearch& search,
                          const TrackedFrame& frame) {
  if (localization_only_) return;  // nobody is told
  const auto entry = [&](MapPointId id) -> Views& {
    if (views_.size() <= id.slot) views_.resize(id.slot + 1);
    Views& views = views_[id.slot];
    if (views.generation != id.generation) views = {id.generation, 0, 0, 0, views.listed};
    if (!std::exchange(views.listed, true)) viewed_.push_back(id.slot);
    return views;
  };
  for (const int i : search.visible) {
    const auto& point = local.points[static_cast<std::size_t>(i)];
    Views& views = entry(point.id);
    ++views.visible;
    if (contradicted(atlas, point.p_world, frame)) ++views.contradicted;
  }
  for (const MapPointId id : frame.points) {
    if (!id.valid()) continue;
    ++entry(id).visible;
    ++entry(id).found;
    entry(id).contradicted = 0;
  }
  for (const PointMatch& m : search.matches) {  // found ones were counted twice
    if (frame.points[static_cast<std::size_t>(m.keypoint)] == m.point) --entry(m.point).visible;
  }
}

std::vector<PointViews> Tracker::take_views() {
  std::sort(viewed_.begin(), viewed_.end());
  std::vector<PointViews> out;
  for (const std::uint32_t slot : viewed_) {
    Views& v = views_[slot];
    v.listed = false;
    if (v.visible <= 0 && v.found <= 0) continue;
    out.push_back({{slot, v.generation}, v.visible, v.found, v.contradicted});
    v.visible = v.found = 0;
  }
  viewed_.clear();
  return out;
}

void Tracker::set_pose(const Atlas& atlas, TrackedFrame& frame, const LocalMap& local,
                       TrackResult& result) {
  result.reference = most_shared_keyframe(atlas, frame.points);
  if (!result.reference.valid()) result.reference = local.reference;
  result.T_world_camera = frame.T_camera_world.inverse();
  result.T_reference_camera =
      atlas.at(result.reference).T_world_camera.inverse() * result.T_world_camera;
}

TrackResult Tracker::finish_tracked(TrackedFrame frame, const Atlas& atlas, TrackResult result,
                                    bool mapper_idle) {
  if (state_ == TrackingState::lost || T_reckoned_last_) {
    log::info("frame {}: tracking again", frame.index);
  }
  take_motion(frame, result);
  state_ = result.state = TrackingState::tracking;
  lost_since_.reset();
  last_reference_ = result.reference;
  T_reference_last_ = result.T_reference_camera;
  result.points = frame.points;
  StageTimer timer(result.times, "keyframe_decision");
  const bool believed = doubt_.settle(frame.stamp);
  if (!localization_only_ && arrival_.settled() && believed && !frame.stale &&
      needs_keyframe(situation(atlas, frame, result, mapper_idle), options_.keyframe)) {
    last_candidate_stamp_ = frame.stamp;
    result.candidate =
        KeyFrameCandidate{frame, result.reference, result.T_reference_camera, take_views()};
  }
  last_ = std::move(frame);
  timer.stop();
  return result;
}

bool Tracker::moves_as_a_body(const TrackedFrame& frame) const {
  const double interval_s = last_ ? seconds_between(last_->stamp, frame.stamp) : 0;
  const DoubtOptions& limits = options_.doubt;
  if (!limits.enabled || interval_s <= 0 || interval_s > limits.longest_s) return true;
  return is_motion_of_a_body(frame.T_camera_world * last_->T_camera_world.inverse(), interval_s,
                             limits);
}

bool Tracker::depth_is_doubtful(const Atlas& atlas, TrackedFrame& frame) {
  const DepthWatch::Verdict verdict =
      depth_watch_.check(atlas.camera(), atlas.scales(), frame.features(), frame.T_camera_world,
                         local_matches_, options_.pose, doubt_.pending());
  if (!verdict.doubtful && frame.doubt.empty()) {
    depth_watch_.learn(verdict);
    return false;
  }
  if (doubt_.lasts_too_long(frame.stamp)) {
    log::warning("frame {}: doubt has lasted for {:g} s; the sensor is believed again", frame.index,
                 options_.doubt.longest_s);
    if (verdict.doubtful) depth_watch_.give_in(verdict);
    return false;
  }
  if (verdict.colour.inliers.empty()) return false;
  frame.points.assign(frame.points.size(), MapPointId{});
  assign(verdict.colour, frame);
  return verdict.doubtful;
}

TrackResult Tracker::finish_coasting(TrackedFrame frame, const Atlas& atlas, TrackResult result,
                                     const std::string& doubt) {
  // Where it was lost, or the colour image says something impossible too, nothing is certain.
  if (state_ == TrackingState::lost || !moves_as_a_body(frame)) {
    return finish_doubted(std::move(frame), atlas, std::move(result), doubt);
  }
  if (doubt_.raise(doubt, frame.stamp)) {
    log::warning("frame {}: coasting: {}; nothing of it enters the map", frame.index, doubt);
  }
  result.state = TrackingState::coasting;
  result.doubt = doubt;
  result.points = frame.points;
  result.reference = most_shared_keyframe(atlas, frame.points);
  if (!result.reference.valid()) result.reference = last_reference_;
  result.T_world_camera = frame.T_camera_world.inverse();
  result.T_reference_camera =
      atlas.at(result.reference).T_world_camera.inverse() * result.T_world_camera;
  take_motion(frame, result);
  last_reference_ = result.reference;
  T_reference_last_ = result.T_reference_camera;
  last_ = colour_only(std::move(frame));
  return result;
}

TrackResult Tracker::finish_doubted(TrackedFrame frame, const Atlas& atlas, TrackResult result,
                                    std::string doubt) {
  result.inliers = 0;
  const std::int64_t index = frame.index;
  const bool first = doubt_.raise(doubt, frame.stamp);
  TrackResult lost = finish_lost(std::move(frame), atlas, std::move(result));
  if (lost.state != TrackingState::lost) return lost;
  if (first) log::warning("frame {}: coasting without a pose: {}", index, doubt);
  lost.state = TrackingState::coasting;
  lost.reference = KeyFrameId{};
  lost.points.clear();
  lost.doubt = doubt;
  return lost;
}

bool Tracker::is_young(const Atlas& atlas) const {
  const KeyFrame* keyframe = atlas.find(last_reference_);
  if (!keyframe) return false;
  int keyframes = 0;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& other) {
    if (other.map == keyframe->map) ++keyframes;
  });
  return keyframes <= options_.young_map_keyframes;
}

TrackResult Tracker::finish_lost(TrackedFrame frame, const Atlas& atlas, TrackResult result) {
  if (state_ == TrackingState::tracking && !doubt_.pending()) {
    log::warning("frame {}: tracking lost ({} points agree)", frame.index, result.inliers);
  }
  if (!lost_since_) lost_since_ = frame.stamp;
  state_ = result.state = TrackingState::lost;
  T_camera_last_.reset();
  T_reckoned_last_.reset();
  unknown_since_.reset();
  // A young map is worth no waiting; if it shows the same room it is merged later.
  const bool young = !doubt_.pending() && is_young(atlas);
  const double wait_s = young ? 0 : options_.new_map_after_s;
  if (seconds_between(*lost_since_, frame.stamp) < wait_s) return result;
  TrackResult fresh = initialize(std::move(frame));
  if (!fresh.candidate) return result;
  log::info("frame {}: {}, starting a new map", last_->index,
            young ? "the map was young" : "lost for too long");
  state_ = TrackingState::initializing;
  lost_since_.reset();
  return fresh;
}

}  // namespace ydd
