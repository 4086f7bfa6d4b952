// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/map_dump.h"

#include <iterator>

#include <fmt/format.h>

namespace ydd {

std::string dump_map(const Atlas& atlas) {
  std::string text;
  auto out = std::back_inserter(text);
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& k) {
    const Eigen::Vector3d& t = k.T_world_camera.translation();
    const Eigen::Quaterniond& q = k.T_world_camera.rotation();
    fmt::format_to(out, "keyframe {}.{} serial {} frame {} stamp {} parent {}.{}\n", id.slot,
                   id.generation, k.serial, k.frame_index, k.stamp.ns, k.parent.slot,
                   k.parent.generation);
    fmt::format_to(out, " pose {:a} {:a} {:a} {:a} {:a} {:a} {:a}\n", t.x(), t.y(), t.z(), q.x(),
                   q.y(), q.z(), q.w());
    for (const Covisible& c : k.covisible) {
      fmt::format_to(out, " covisible {}.{} {}\n", c.keyframe.slot, c.keyframe.generation,
                     c.weight);
    }
  });
  atlas.points().for_each([&](MapPointId id, const MapPoint& p) {
    fmt::format_to(out, "point {}.{} at {:a} {:a} {:a} descriptor {:x} {:x} {:x} {:x}\n", id.slot,
                   id.generation, p.p_world.x(), p.p_world.y(), p.p_world.z(), p.descriptor[0],
                   p.descriptor[1], p.descriptor[2], p.descriptor[3]);
    for (const Sighting& s : p.sightings) {
      fmt::format_to(out, " seen {}.{} {}\n", s.keyframe.slot, s.keyframe.generation, s.keypoint);
    }
  });
  return text;
}

}  // namespace ydd
