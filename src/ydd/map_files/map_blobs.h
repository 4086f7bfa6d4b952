// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ydd/map/atlas.h"

/// Values of the map as bytes and back, bit by bit. Inside the room only; docs/maps.md has the
/// layout. Reading throws Fault on bytes that this cannot have written.
namespace ydd::map_format {

std::string encode_pose(const SE3& pose);
SE3 decode_pose(std::string_view bytes);

/// Calibration; the name is not in it.
std::string encode_camera(const Camera& camera);
Camera decode_camera(std::string_view bytes);

std::string encode_scales(const PyramidScales& scales);
PyramidScales decode_scales(std::string_view bytes);

/// 65 bytes a keypoint.
std::string encode_features(const Features& features);
Features decode_features(std::string_view bytes);

std::string encode_covisible(const std::vector<Covisible>& list);
std::vector<Covisible> decode_covisible(std::string_view bytes);

std::string encode_bag(const BagOfWords& bag);
BagOfWords decode_bag(std::string_view bytes);

/// Numbers of the blocks that hold these points (empty ids: none), ascending, each once.
std::string encode_blocks_of(const std::vector<MapPointId>& points);
std::vector<std::uint32_t> decode_blocks(std::string_view bytes);

template <class Tag>
std::string encode_ids(const std::vector<Id<Tag>>& ids);
template <class Tag>
std::vector<Id<Tag>> decode_ids(std::string_view bytes);

/// Points of neighbouring slots in one blob.
class PointBlock {
 public:
  void add(MapPointId id, const MapPoint& point);
  std::string take();

 private:
  std::string bytes_;
};
void decode_points(std::string_view bytes, std::vector<std::pair<MapPointId, MapPoint>>& out);

}  // namespace ydd::map_format
