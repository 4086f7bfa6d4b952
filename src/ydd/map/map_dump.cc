// SPDX-License-Identifier: Apache-2.0
#include "ydd/map/map_dump.h"

#include <iterator>

#include <fmt/format.h>

#include "ydd/base/byte_writer.h"
#include "ydd/base/checksum.h"

namespace ydd {
namespace {

std::uint64_t sum_of(std::string_view bytes) {
  Checksum sum;
  sum.add(bytes);
  return sum.value();
}

std::string bytes_of(const SE3& pose) {
  ByteWriter out;
  for (int i = 0; i < 3; ++i) out.f64(pose.translation()[i]);
  for (int i = 0; i < 4; ++i) out.f64(pose.rotation().coeffs()[i]);
  return std::move(out).take();
}

std::string bytes_of(const Features& features) {
  ByteWriter out;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Keypoint& k = features.keypoints[i];
    for (const float value :
         {k.x_px, k.y_px, k.angle_rad, k.response, features.depth_m[i], features.right_px[i]}) {
      out.f32(value);
    }
    out.varint(static_cast<std::uint64_t>(k.octave));
    for (int c = 0; c < 2; ++c) out.f32(features.undistorted_px[i][c]);
    for (const std::uint64_t word : features.descriptors[i]) out.fixed(word);
  }
  return std::move(out).take();
}

}  // namespace

std::string dump_map(const Atlas& atlas) {
  std::string text;
  auto out = std::back_inserter(text);
  atlas.keyframes().for_each([&](KeyFrameId id, const KeyFrame& k) {
    const Eigen::Vector3d& t = k.T_world_camera.translation();
    const Eigen::Quaterniond& q = k.T_world_camera.rotation();
    fmt::format_to(out, "keyframe {}.{} serial {} frame {} stamp {} parent {}.{} map {}\n", id.slot,
                   id.generation, k.serial, k.frame_index, k.stamp.ns, k.parent.slot,
                   k.parent.generation, k.map.slot);
    fmt::format_to(out, " pose {:a} {:a} {:a} {:a} {:a} {:a} {:a}\n", t.x(), t.y(), t.z(), q.x(),
                   q.y(), q.z(), q.w());
    for (const Covisible& c : k.covisible) {
      fmt::format_to(out, " covisible {}.{} {}\n", c.keyframe.slot, c.keyframe.generation,
                     c.weight);
    }
    for (const KeyFrameId loop : k.loops) {
      fmt::format_to(out, " loop {}.{}\n", loop.slot, loop.generation);
    }
    fmt::format_to(out, " keypoints {} sum {:x}\n", k.features().size(),
                   sum_of(bytes_of(k.features())));
    if (k.picture) {
      fmt::format_to(out, " picture {}x{} sum {:x} {:x}\n", k.picture->width_px,
                     k.picture->height_px, sum_of(k.picture->colour_jpeg),
                     sum_of(k.picture->depth_png));
    }
  });
  atlas.culled().for_each([&](KeyFrameId id, const CulledKeyFrame& culled) {
    fmt::format_to(out, "culled {}.{} parent {}.{} pose sum {:x}\n", id.slot, id.generation,
                   culled.parent.slot, culled.parent.generation,
                   sum_of(bytes_of(culled.T_parent_keyframe)));
  });
  atlas.points().for_each([&](MapPointId id, const MapPoint& p) {
    fmt::format_to(out, "point {}.{} at {:a} {:a} {:a} descriptor {:x} {:x} {:x} {:x}\n", id.slot,
                   id.generation, p.p_world.x(), p.p_world.y(), p.p_world.z(), p.descriptor[0],
                   p.descriptor[1], p.descriptor[2], p.descriptor[3]);
    fmt::format_to(out, " normal {:a} {:a} {:a} range {:a} {:a} born {} views {} {}\n",
                   p.normal.x(), p.normal.y(), p.normal.z(), p.min_distance_m, p.max_distance_m,
                   p.born, p.visible, p.found);
    for (const Observation& s : p.observations) {
      fmt::format_to(out, " seen {}.{} {}\n", s.keyframe.slot, s.keyframe.generation, s.keypoint);
    }
  });
  return text;
}

}  // namespace ydd
