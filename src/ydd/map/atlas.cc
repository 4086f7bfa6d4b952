// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/atlas.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>
#include <utility>

namespace ydd {
namespace {

auto observation_by(const MapPoint& point, KeyFrameId keyframe) {
  return std::find_if(point.observations.begin(), point.observations.end(),
                      [&](const Observation& s) { return s.keyframe == keyframe; });
}

}  // namespace

Atlas::Atlas(const Camera& camera, const PyramidScales& scales)
    : camera_(camera), scales_(scales) {}

Atlas::Atlas(const Atlas& other, Table<KeyFrame, KeyFrameTag> keyframes,
             Table<MapPoint, MapPointTag> points)
    : camera_(other.camera_),
      scales_(other.scales_),
      keyframes_(std::move(keyframes)),
      points_(std::move(points)),
      culled_(other.culled_),
      word_index_(other.word_index_),
      revision_(other.revision_),
      newest_(other.newest_),
      next_serial_(other.next_serial_),
      maps_(other.maps_),
      far_(other.far_) {}

std::shared_ptr<const Atlas> Atlas::snapshot() {
  return std::shared_ptr<const Atlas>(new Atlas(*this, keyframes_.snapshot(), points_.snapshot()));
}

Atlas Atlas::fork() const { return {*this, keyframes_.fork(), points_.fork()}; }

Atlas::Newer Atlas::adopt_places(const Atlas& before, const Atlas& fork) {
  ++revision_;
  Newer newer;
  keyframes_.adopt(before.keyframes_, fork.keyframes_,
                   [&](KeyFrameId id) { newer.keyframes.push_back(id); });
  points_.adopt(before.points_, fork.points_, [&](MapPointId id) { newer.points.push_back(id); });
  return newer;
}

MapId Atlas::new_map() {
  ++revision_;
  return {maps_++, 1};
}

KeyFrameId Atlas::add_keyframe(KeyFrame keyframe) {
  ++revision_;
  keyframe.serial = next_serial_++;
  const std::vector<MapPointId> wanted = std::move(keyframe.points);
  keyframe.points.assign(keyframe.features().size(), MapPointId{});
  keyframe.covisible.clear();
  keyframe.children.clear();
  const KeyFrameId parent = std::exchange(keyframe.parent, {});
  WordIndex::Entry words{keyframe.serial, {}, keyframe.words};
  const KeyFrameId id = words.keyframe = keyframes_.insert(std::move(keyframe));
  if (words.words) word_index_.add(std::move(words));
  newest_ = id;
  link_parent(id, parent);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (points_.contains(wanted[i])) add_observation(wanted[i], id, static_cast<int>(i));
  }
  return id;
}

MapPointId Atlas::add_point(const Eigen::Vector3d& p_world, KeyFrameId keyframe, int keypoint) {
  const KeyFrame& seen_by = keyframes_.at(keyframe);
  if (seen_by.points.at(static_cast<std::size_t>(keypoint)).valid()) {
    throw std::logic_error("Atlas: add_point on a keypoint that has a point");
  }
  MapPoint point;
  point.p_world = p_world;
  point.born = seen_by.serial;
  const MapPointId id = points_.insert(std::move(point));
  add_observation(id, keyframe, keypoint);
  refresh_point(id);
  return id;
}

bool Atlas::add_observation(MapPointId point, KeyFrameId keyframe, int keypoint) {
  const auto k = static_cast<std::size_t>(keypoint);
  const KeyFrame& seen_by = keyframes_.at(keyframe);
  const MapPoint& seen = points_.at(point);
  if (seen_by.points.at(k).valid() || observation_by(seen, keyframe) != seen.observations.end()) {
    return false;
  }
  ++revision_;
  keyframes_.edit(keyframe).points[k] = point;
  points_.edit(point).observations.push_back({keyframe, keypoint});
  return true;
}

void Atlas::unlink(MapPointId point, const Observation& observation) {
  ++revision_;
  keyframes_.edit(observation.keyframe).points[static_cast<std::size_t>(observation.keypoint)] = {};
  std::erase(points_.edit(point).observations, observation);
}

void Atlas::remove_observation(MapPointId point, KeyFrameId keyframe) {
  const MapPoint& seen = points_.at(point);
  const auto found = observation_by(seen, keyframe);
  if (found == seen.observations.end()) return;
  unlink(point, Observation(*found));
  if (points_.at(point).observations.empty()) points_.erase(point);
}

void Atlas::remove_point(MapPointId point) {
  const std::vector<Observation> observations = points_.at(point).observations;
  for (const Observation& observation : observations) unlink(point, observation);
  points_.erase(point);
}

void Atlas::merge_points(MapPointId from, MapPointId into) {
  if (from == into) return;
  points_.at(into);  // throws before anything is changed
  const MapPoint replaced = points_.at(from);
  remove_point(from);
  for (const Observation& s : replaced.observations) add_observation(into, s.keyframe, s.keypoint);
  count_views(into, replaced.visible, replaced.found);
  refresh_point(into);
}

void Atlas::set_pose(KeyFrameId keyframe, const SE3& T_world_camera) {
  ++revision_;
  keyframes_.edit(keyframe).T_world_camera = T_world_camera;
}

void Atlas::set_position(MapPointId point, const Eigen::Vector3d& p_world) {
  ++revision_;
  points_.edit(point).p_world = p_world;
}

void Atlas::set_parent(KeyFrameId keyframe, KeyFrameId parent) {
  ++revision_;
  link_parent(keyframe, parent);
}

void Atlas::set_map(KeyFrameId keyframe, MapId map) {
  ++revision_;
  keyframes_.edit(keyframe).map = map;
}

void Atlas::add_loop(KeyFrameId a, KeyFrameId b) {
  ++revision_;
  keyframes_.edit(a).loops.push_back(b);
  keyframes_.edit(b).loops.push_back(a);
}

void Atlas::count_views(MapPointId point, int visible, int found) {
  ++revision_;
  MapPoint& p = points_.edit(point);
  p.visible += visible;
  p.found += found;
}

void Atlas::refresh_point(MapPointId id) {
  ++revision_;
  MapPoint& point = points_.edit(id);
  if (point.observations.empty()) return;
  std::vector<Descriptor> descriptors;
  descriptors.reserve(point.observations.size());
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (const Observation& s : point.observations) {
    const KeyFrame& keyframe = keyframes_.at(s.keyframe);
    descriptors.push_back(keyframe.features().descriptors[static_cast<std::size_t>(s.keypoint)]);
    normal += (point.p_world - keyframe.T_world_camera.translation()).normalized();
  }
  point.descriptor = median_descriptor(descriptors);
  point.normal = normal.normalized();
  // The oldest observation fixes the scale range: a keypoint on octave o at distance d would be
  // seen on octave 0 at d * factor[o].
  const Observation& first = point.observations.front();
  const KeyFrame& reference = keyframes_.at(first.keyframe);
  const int octave =
      reference.features().keypoints[static_cast<std::size_t>(first.keypoint)].octave;
  const double distance_m = (point.p_world - reference.T_world_camera.translation()).norm();
  point.max_distance_m = distance_m * scales_.factor[static_cast<std::size_t>(octave)];
  point.min_distance_m = point.max_distance_m / scales_.factor.back();
}

std::optional<SE3> Atlas::T_world_keyframe(KeyFrameId id) const {
  SE3 T_ancestor_keyframe;
  for (;;) {
    if (const KeyFrame* keyframe = keyframes_.find(id)) {
      return keyframe->T_world_camera * T_ancestor_keyframe;
    }
    if (const FarKeyFrame* far = find_far(id)) return far->T_world_camera * T_ancestor_keyframe;
    const CulledKeyFrame* culled = culled_.find(id);
    if (!culled) return std::nullopt;
    T_ancestor_keyframe = culled->T_parent_keyframe * T_ancestor_keyframe;
    id = culled->parent;
  }
}

const FarKeyFrame* Atlas::find_far(KeyFrameId id) const {
  if (!far_) return nullptr;
  const auto found = far_->find(id);
  return found == far_->end() ? nullptr : &found->second;
}

KeyFrameId Atlas::nearest_kept(KeyFrameId id) const {
  while (!keyframes_.contains(id)) {
    const CulledKeyFrame* culled = culled_.find(id);
    if (!culled) return {};
    id = culled->parent;
  }
  return id;
}

MapId Atlas::map_of(KeyFrameId id) const {
  for (;;) {
    if (const KeyFrame* keyframe = keyframes_.find(id)) return keyframe->map;
    if (const FarKeyFrame* far = find_far(id)) return far->map;
    const CulledKeyFrame* culled = culled_.find(id);
    if (!culled) return {};
    id = culled->parent;
  }
}

}  // namespace ydd
