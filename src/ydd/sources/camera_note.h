// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "ydd/base/result.h"
#include "ydd/geometry/camera.h"

namespace ydd {

/// Under which name our own bags keep the camera of a run (McapWriter::add_metadata): CameraInfo
/// knows neither the limits of depth nor the pace.
inline constexpr const char* kCameraNote = "ydd_slam.camera";

std::map<std::string, std::string> camera_note(const Camera& camera);
/// Fails for what no camera can be.
Result<Camera> camera_of_note(const std::map<std::string, std::string>& note);

}  // namespace ydd
