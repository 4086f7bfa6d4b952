// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "ydd/map/atlas.h"
#include "ydd/map_files/database.h"

/// What the cells of a row mean. Inside the room only. All of it throws Fault on what this cannot
/// have written.
namespace ydd::map_format {

/// The slot that is the key of a row.
std::uint32_t slot_of(const Row& row);
/// The keyframe that a row with its slot and generation is about.
KeyFrameId keyframe_id_of(const Row& row);

/// The one row of kAtlas.
struct AtlasRow {
  AtlasParts parts;  ///< without keyframes, points and culled ones
  std::uint32_t keyframes = 0, points = 0;
  std::uint64_t digest = 0;

  std::uint32_t keyframe_slots() const {
    return keyframes + static_cast<std::uint32_t>(parts.freed_keyframes.size());
  }
  std::uint32_t point_slots() const {
    return points + static_cast<std::uint32_t>(parts.freed_points.size());
  }
};
AtlasRow decode_atlas_row(const Row& row);

/// Of kKeyframe or kKeyframe1: without what other tables have.
KeyFrame decode_keyframe_row(const Row& row);
/// Of kKeyframe: the blocks in which its points are.
std::vector<std::uint32_t> decode_block_list(const Row& row);

/// Of kFeatures: gives them, and a grid over them, to the keyframe.
void decode_features_row(const Row& row, const Camera& camera, KeyFrame& keyframe);
/// Of kWords; nothing if they are of another vocabulary.
std::optional<BagOfWords> decode_words_row(const Row& row);
/// The bag of a keyframe that has features and no words.
std::shared_ptr<const BagOfWords> words_of(const KeyFrame& keyframe);

}  // namespace ydd::map_format
