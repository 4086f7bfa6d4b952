// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "ydd/map_files/database.h"

/// The tables of a map file (docs/maps.md describes them). Inside the room only.
namespace ydd::map_format {

inline constexpr std::int64_t kApplicationId = 0x59444453;  // "YDDS"
/// To be raised by whoever changes a table or a blob; readers of older versions go to load_map.cc.
inline constexpr std::int64_t kVersion = 1;
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
inline const TableShape kKeyframe = {"keyframe",
                                     {"generation", "serial", "frame_index", "stamp_ns", "map",
                                      "parent", "parent_generation", "pose", "covisible", "loops"}};
/// What never changes; key: slot of the keyframe.
inline const TableShape kFeatures = {"features", {"generation", "keypoints"}};
inline const TableShape kPicture = {"picture",
                                    {"generation", "width", "height", "colour", "depth"}};
/// Key: generation * 2^32 + slot.
inline const TableShape kCulled = {"culled", {"parent", "parent_generation", "pose"}};
/// Key: slot / kPointsPerBlock.
inline const TableShape kPoints = {"points", {"points"}};

inline const TableShape* const kContent[] = {&kKeyframe, &kFeatures, &kPicture, &kCulled, &kPoints};
inline const TableShape* const kTables[] = {&kAtlas,   &kKeyframe, &kFeatures,
                                            &kPicture, &kCulled,   &kPoints};

}  // namespace ydd::map_format
