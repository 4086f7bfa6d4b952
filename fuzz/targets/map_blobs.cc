// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/map_blobs.h"
#include "support.h"
#include "targets.h"
#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_schema.h"

namespace ydd::fuzz {
namespace {

using namespace map_format;  // NOLINT(google-build-using-namespace): all of it is tried

std::string points_again(std::string_view bytes) {
  std::vector<std::pair<MapPointId, MapPoint>> points;
  decode_points(bytes, points);
  PointBlock block;
  for (const auto& [id, point] : points) block.add(id, point);
  return block.take();
}

std::string blocks_again(std::string_view bytes) {
  std::vector<MapPointId> points;
  for (const std::uint32_t block : decode_blocks(bytes)) {
    points.push_back({block * kPointsPerBlock + 7, 1});
  }
  return encode_blocks_of(points);
}

std::string again(unsigned kind, std::string_view bytes) {
  switch (kind % 9) {
    case 0:
      return encode_pose(decode_pose(bytes));
    case 1:
      return encode_camera(decode_camera(bytes));
    case 2:
      return encode_scales(decode_scales(bytes));
    case 3:
      return encode_features(decode_features(bytes));
    case 4:
      return encode_covisible(decode_covisible(bytes));
    case 5:
      return encode_ids(decode_ids<KeyFrameTag>(bytes));
    case 6:
      return points_again(bytes);
    case 7:
      return encode_bag(decode_bag(bytes));
    default:
      return blocks_again(bytes);
  }
}

}  // namespace

// The kind of blob, then its bytes. What was read and written is read and written alike.
void map_blobs(std::string_view input) {
  Pieces pieces(input);
  const unsigned kind = pieces.byte();
  std::string once;
  try {
    once = again(kind, pieces.text(input.size()));
  } catch (const Fault&) {
    return;
  }
  if (again(kind, once) != once) broken("read again otherwise");
}

}  // namespace ydd::fuzz
