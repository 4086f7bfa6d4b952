// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "ydd/map_files/database.h"

/// The tables of a map file (docs/maps.md describes them). Inside the room only.
namespace ydd::map_format {

inline constexpr std::int64_t kApplicationId = 0x59444453;  // "YDDS"
/// To be raised by whoever changes a table or a blob; readers of older versions go to load_map.cc.
inline constexpr std::int64_t kVersion = 2;
/// Bytes of a page of an encrypted file.
inline constexpr std::size_t kCipherPage = 4096;
/// Slots whose points share a row: as many as share a chunk in memory.
inline constexpr std::uint32_t kPointsPerBlock = 64;

/// One row, written last: it vouches for all others.
inline const TableShape kAtlas = {
    "atlas",
    {"program", "camera_name", "camera", "scales", "revision", "next_serial", "maps", "newest",
     "newest_generation", "freed_keyframes", "freed_points", "keyframes", "points", "digest"}};
/// What changes; key: slot.
inline const TableShape kKeyframe = {
    "keyframe",
    {"generation", "serial", "frame_index", "stamp_ns", "map", "parent", "parent_generation",
     "pose", "covisible", "loops", "point_blocks"}};
/// What never changes; key: slot of the keyframe.
inline const TableShape kFeatures = {"features", {"generation", "keypoints"}};
/// The same of a picture as words; "vocabulary" is vocabulary_mark().
inline const TableShape kWords = {"words", {"generation", "serial", "vocabulary", "bag"}};
inline const TableShape kPicture = {"picture",
                                    {"generation", "width", "height", "colour", "depth"}};
/// Key: generation * 2^32 + slot.
inline const TableShape kCulled = {"culled", {"parent", "parent_generation", "pose"}};
/// Key: slot / kPointsPerBlock.
inline const TableShape kPoints = {"points", {"points"}};

inline const TableShape* const kContent[] = {&kKeyframe, &kFeatures, &kWords,
                                             &kPicture,  &kCulled,   &kPoints};
inline const TableShape* const kTables[] = {&kAtlas,   &kKeyframe, &kFeatures, &kWords,
                                            &kPicture, &kCulled,   &kPoints};

/// Files of version 1: keyframes did not say where their points are, and had no words.
inline const TableShape kKeyframe1 = {
    "keyframe",
    {"generation", "serial", "frame_index", "stamp_ns", "map", "parent", "parent_generation",
     "pose", "covisible", "loops"}};
inline const TableShape* const kContent1[] = {&kKeyframe1, &kFeatures, &kPicture, &kCulled,
                                              &kPoints};
inline const TableShape* const kTables1[] = {&kAtlas,   &kKeyframe1, &kFeatures,
                                             &kPicture, &kCulled,    &kPoints};

/// The tables of a file of some version, with and without kAtlas.
inline std::span<const TableShape* const> tables_of(std::int64_t version) {
  if (version == 1) return kTables1;
  return kTables;
}
inline std::span<const TableShape* const> content_of(std::int64_t version) {
  if (version == 1) return kContent1;
  return kContent;
}

}  // namespace ydd::map_format
