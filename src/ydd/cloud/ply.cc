// SPDX-License-Identifier: Apache-2.0
#include "ydd/cloud/ply.h"

#include <fmt/format.h>

#include "ydd/base/byte_writer.h"

namespace ydd {
namespace {

std::string header(std::size_t points, std::string_view properties) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment ydd-slam, metres\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n{}end_header\n",
      points, properties);
}

}  // namespace

std::string format_ply(std::span<const CloudPoint> points) {
  ByteWriter out;
  for (const CloudPoint& point : points) {
    for (int i = 0; i < 3; ++i) out.f32(point.p_world[i]);
    for (const std::size_t c : {2U, 1U, 0U}) out.fixed(point.colour[c]);
  }
  return header(points.size(), "property uchar red\nproperty uchar green\nproperty uchar blue\n") +
         std::move(out).take();
}

std::string format_sparse_ply(const Atlas& atlas, MapId map) {
  ByteWriter out;
  std::size_t points = 0;
  atlas.points().for_each([&](MapPointId, const MapPoint& point) {
    if (atlas.map_of(point.observations.front().keyframe) != map) return;
    ++points;
    for (int i = 0; i < 3; ++i) out.f32(static_cast<float>(point.p_world[i]));
    for (int i = 0; i < 3; ++i) out.f32(static_cast<float>(-point.normal[i]));
    out.fixed(static_cast<std::uint32_t>(point.observations.size()));
  });
  return header(points,
                "property float nx\nproperty float ny\nproperty float nz\n"
                "property int observations\n") +
         std::move(out).take();
}

}  // namespace ydd
