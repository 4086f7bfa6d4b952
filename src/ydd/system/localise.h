// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ydd/image/rgbd_frame.h"
#include "ydd/map/atlas.h"
#include "ydd/system/system_options.h"

namespace ydd {

/// Where a camera is in a known map.
struct Located {
  SE3 T_world_camera;  ///< where it is, in that map's world
  MapId map;           ///< of the atlas
  int inliers = 0;     ///< map points that agree
};

/// Where one picture of the atlas' camera was taken, by what it shows alone; nothing when its place
/// is not recognised. The pyramid of `options` must be that of the atlas. Pictures of a sequence
/// are better given to a SlamSystem with the map and set_localization_only, which knows where it
/// was before. Deterministic; any thread.
std::optional<Located> localise(const Atlas& atlas, const RgbdFrame& frame,
                                const SystemOptions& options = {});

}  // namespace ydd
