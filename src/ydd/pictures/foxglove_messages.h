// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/timestamp.h"
#include "ydd/geometry/se3.h"
#include "ydd/image/image.h"
#include "ydd/map/atlas.h"
#include "ydd/tracks/world_tracker.h"

/// Messages that Foxglove shows, as JSON (https://docs.foxglove.dev/docs/sdk/schemas), and their
/// schemas. Metres; poses are in the frame "world" (x right, y down, z ahead of a map's first
/// camera), which lies in "map" (z up).
namespace ydd::foxglove {

/// The JSON schema of "foxglove.PoseInFrame", "foxglove.FrameTransform",
/// "foxglove.CompressedImage", "foxglove.PointCloud" or "foxglove.SceneUpdate"; empty: none of
/// these.
std::string_view schema_of(std::string_view name);

std::string pose_in_frame(Timestamp stamp, const SE3& T_world_camera);
/// "child" in "parent".
std::string frame_transform(Timestamp stamp, std::string_view parent, std::string_view child,
                            const SE3& T_parent_child);
/// Where "world" is in "map".
SE3 world_in_map();
/// `jpeg`: the file's bytes.
std::string compressed_image(Timestamp stamp, std::string_view jpeg);
/// The points of the map that is worked on, at most about `most`.
std::string point_cloud(Timestamp stamp, const Atlas& atlas, MapId map, std::size_t most);
/// Boxes with names and where each goes in a second; what was there before is gone.
std::string scene_update(Timestamp stamp, const std::vector<WorldTrack>& tracks);

std::string base64(std::string_view bytes);

}  // namespace ydd::foxglove
