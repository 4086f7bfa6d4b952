// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ydd/base/result.h"

namespace ydd {

/// Size and pace of a stream of pictures.
struct CameraMode {
  int width_px = 0, height_px = 0, fps = 0;

  auto operator<=>(const CameraMode&) const = default;
};

/// "640x480@30"
std::string to_string(const CameraMode& mode);

/// "640x480@30", "320x240@15"; nothing when it is none.
std::optional<CameraMode> parse_camera_mode(const std::string& text);

/// In the order of size and pace, each once: "320x240@30, 640x480@30", or "none".
std::string listed(std::vector<CameraMode> modes);

/// The mode in which both streams can run: `wanted` (empty: 640x480 at 30 Hz, or what comes nearest
/// to it: rather smaller than larger, rather faster than slower). One line lists what there is.
Result<CameraMode> choose_camera_mode(const std::vector<CameraMode>& colour,
                                      const std::vector<CameraMode>& depth,
                                      const std::string& wanted);

}  // namespace ydd
