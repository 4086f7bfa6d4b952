// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/join_atlases.h"

#include "ydd/map/compatible.h"

namespace ydd {
namespace {

/// How the names of an atlas change when it moves in behind another.
class Shift {
 public:
  explicit Shift(const Atlas& before)
      : keyframes_(before.keyframes().slots()),
        points_(before.points().slots()),
        maps_(before.maps()),
        serials_(before.next_serial()) {}

  KeyFrameId operator()(KeyFrameId id) const {
    return id.valid() ? KeyFrameId{id.slot + keyframes_, id.generation} : id;
  }
  MapPointId operator()(MapPointId id) const {
    return id.valid() ? MapPointId{id.slot + points_, id.generation} : id;
  }
  MapId operator()(MapId id) const { return {id.slot + maps_, id.generation}; }

  KeyFrame operator()(KeyFrame keyframe) const {
    keyframe.serial += serials_;
    keyframe.map = (*this)(keyframe.map);
    keyframe.parent = (*this)(keyframe.parent);
    for (Covisible& c : keyframe.covisible) c.keyframe = (*this)(c.keyframe);
    for (KeyFrameId& loop : keyframe.loops) loop = (*this)(loop);
    return keyframe;
  }
  MapPoint operator()(MapPoint point) const {
    point.born += serials_;
    for (Observation& s : point.observations) s.keyframe = (*this)(s.keyframe);
    return point;
  }

 private:
  std::uint32_t keyframes_, points_, maps_;
  std::int64_t serials_;
};

/// Appends everything of `atlas`, renamed by `shift`.
template <class Rename>
void append(AtlasParts& parts, const Atlas& atlas, const Rename& shift) {
  atlas.keyframes().for_each(
      [&](KeyFrameId id, const KeyFrame& k) { parts.keyframes.emplace_back(shift(id), shift(k)); });
  atlas.points().for_each(
      [&](MapPointId id, const MapPoint& p) { parts.points.emplace_back(shift(id), shift(p)); });
  for (const KeyFrameId id : atlas.keyframes().freed()) parts.freed_keyframes.push_back(shift(id));
  for (const MapPointId id : atlas.points().freed()) parts.freed_points.push_back(shift(id));
  atlas.culled().for_each([&](KeyFrameId id, const CulledKeyFrame& culled) {
    parts.culled[shift(id)] = {shift(culled.parent), culled.T_parent_keyframe};
  });
}

}  // namespace

Result<Atlas> join_atlases(const Atlas& a, const Atlas& b) {
  if (auto same = check_same_camera(a.camera(), b.camera()); !same) return same.error();
  if (auto same = check_same_scales(a.scales(), b.scales()); !same) return same.error();
  AtlasParts parts;
  parts.camera = a.camera();
  parts.scales = a.scales();
  const Shift behind(a);
  append(parts, a, [](const auto& value) { return value; });
  append(parts, b, behind);
  parts.revision = a.revision() + b.revision();
  parts.newest = b.newest_keyframe().valid() ? behind(b.newest_keyframe()) : a.newest_keyframe();
  parts.next_serial = a.next_serial() + b.next_serial();
  parts.maps = a.maps() + b.maps();
  return Atlas::restore(std::move(parts));
}

}  // namespace ydd
