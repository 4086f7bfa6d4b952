// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/local_map.h"

#include <algorithm>

namespace ydd {
namespace {

constexpr std::size_t kNeighboursPerKeyframe = 10;

/// Set of ids of one table as a bit by slot: clearing a map of millions takes microseconds.
class SlotSet {
 public:
  explicit SlotSet(std::uint32_t slots) : flags_(slots, false) {}
  /// False if it was in already.
  bool insert(std::uint32_t slot) {
    if (flags_[slot]) return false;
    flags_[slot] = true;
    return true;
  }

 private:
  std::vector<bool> flags_;
};

/// The keyframes that see any of `points`, those that see most first, ties to the newest.
std::vector<Covisible> voters(const Atlas& atlas, std::span<const MapPointId> points) {
  std::vector<int> votes(atlas.keyframes().slots(), 0);
  std::vector<Covisible> list;
  list.reserve(64);
  for (const MapPointId id : points) {
    const MapPoint* point = atlas.find(id);
    if (!point) continue;
    for (const Observation& s : point->observations) {
      if (++votes[s.keyframe.slot] == 1) list.push_back({s.keyframe, 0});
    }
  }
  for (Covisible& voter : list) voter.weight = votes[voter.keyframe.slot];
  std::sort(list.begin(), list.end(), [&](const Covisible& a, const Covisible& b) {
    if (a.weight != b.weight) return a.weight > b.weight;
    return atlas.at(a.keyframe).serial > atlas.at(b.keyframe).serial;
  });
  return list;
}

void append_points(const Atlas& atlas, KeyFrameId id, SlotSet& seen, LocalMap& local) {
  for (const MapPointId point_id : atlas.at(id).points) {
    if (!point_id.valid() || !seen.insert(point_id.slot)) continue;
    const MapPoint& point = atlas.at(point_id);
    local.points.push_back({point.p_world, point.normal, point.min_distance_m, point.max_distance_m,
                            point.descriptor, point_id});
  }
}

}  // namespace

KeyFrameId most_shared_keyframe(const Atlas& atlas, std::span<const MapPointId> points) {
  const std::vector<Covisible> list = voters(atlas, points);
  return list.empty() ? KeyFrameId{} : list.front().keyframe;
}

LocalMap gather_local_map(const Atlas& atlas, std::span<const MapPointId> points,
                          KeyFrameId fallback, int max_keyframes) {
  LocalMap local;
  local.revision = atlas.revision();
  SlotSet seen_keyframes(atlas.keyframes().slots());
  const auto take = [&](KeyFrameId id) {
    if (local.keyframes.size() < static_cast<std::size_t>(max_keyframes) && atlas.find(id) &&
        seen_keyframes.insert(id.slot)) {
      local.keyframes.push_back(id);
    }
  };
  for (const Covisible& voter : voters(atlas, points)) take(voter.keyframe);
  if (local.keyframes.empty()) take(fallback);
  if (local.keyframes.empty()) return local;
  local.reference = local.keyframes.front();
  const std::size_t direct = local.keyframes.size();
  for (std::size_t i = 0; i < direct; ++i) {
    const KeyFrame& keyframe = atlas.at(local.keyframes[i]);
    const std::size_t n = std::min(kNeighboursPerKeyframe, keyframe.covisible.size());
    for (std::size_t k = 0; k < n; ++k) take(keyframe.covisible[k].keyframe);
    take(keyframe.parent);
  }
  // One allocation instead of a dozen: a keyframe brings some hundred points that are not there
  // yet.
  constexpr std::size_t kNewPerKeyframe = 200;
  local.points.reserve(std::min(atlas.points().size(), kNewPerKeyframe * local.keyframes.size()));
  SlotSet seen_points(atlas.points().slots());
  for (const KeyFrameId id : local.keyframes) append_points(atlas, id, seen_points, local);
  return local;
}

}  // namespace ydd
