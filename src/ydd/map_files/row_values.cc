// SPDX-License-Identifier: Apache-2.0
#include "ydd/map_files/row_values.h"

#include <utility>

#include "ydd/map_files/map_blobs.h"
#include "ydd/map_files/map_bytes.h"
#include "ydd/map_files/map_rows.h"

namespace ydd::map_format {

std::uint32_t slot_of(const Row& row) {
  if (row.key < 0 || row.key > UINT32_MAX) throw Fault("a slot that is too large");
  return static_cast<std::uint32_t>(row.key);
}

KeyFrameId keyframe_id_of(const Row& row) { return {slot_of(row), row.number(0)}; }

AtlasRow decode_atlas_row(const Row& row) {
  constexpr std::uint32_t kMostMaps = 1'000'000;
  AtlasRow out;
  AtlasParts& parts = out.parts;
  parts.camera = decode_camera(row.bytes(2));
  parts.camera.name = row.bytes(1);
  parts.scales = decode_scales(row.bytes(3));
  parts.revision = static_cast<std::uint64_t>(row.integer(4));
  parts.next_serial = row.integer(5);
  parts.maps = row.number(6, kMostMaps);
  parts.newest = {row.number(7), row.number(8)};
  parts.freed_keyframes = decode_ids<KeyFrameTag>(row.bytes(9));
  parts.freed_points = decode_ids<MapPointTag>(row.bytes(10));
  out.keyframes = row.number(11);
  out.points = row.number(12);
  out.digest = static_cast<std::uint64_t>(row.integer(13));
  return out;
}

KeyFrame decode_keyframe_row(const Row& row) {
  KeyFrame k;
  k.serial = row.integer(1);
  k.frame_index = row.integer(2);
  k.stamp = {row.integer(3)};
  k.map = {row.number(4), 1};
  k.parent = {row.number(5), row.number(6)};
  k.T_world_camera = decode_pose(row.bytes(7));
  k.covisible = decode_covisible(row.bytes(8));
  k.loops = decode_ids<KeyFrameTag>(row.bytes(9));
  return k;
}

std::vector<std::uint32_t> decode_block_list(const Row& row) {
  return decode_blocks(row.bytes(10));
}

void decode_features_row(const Row& row, const Camera& camera, KeyFrame& keyframe) {
  const auto features = std::make_shared<const Features>(decode_features(row.bytes(1)));
  keyframe.grid = std::make_shared<const KeypointGrid>(*features, camera);
  keyframe.shared_features = features;
}

std::optional<BagOfWords> decode_words_row(const Row& row) {
  if (row.integer(2) != vocabulary_mark()) return std::nullopt;
  return decode_bag(row.bytes(3));
}

std::shared_ptr<const BagOfWords> words_of(const KeyFrame& keyframe) {
  return std::make_shared<const BagOfWords>(
      bag_of_words(builtin_vocabulary(), keyframe.features().descriptors));
}

}  // namespace ydd::map_format
