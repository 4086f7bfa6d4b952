// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "ydd/base/result.h"
#include "ydd/geometry/camera.h"

namespace ydd {

/// Reads a camera from YAML, either ours (the keys of Camera::describe; width, height, fx, fy, cx
/// and cy must be there, the rest has defaults) or a settings file of ORB-SLAM3 for an RGB-D camera
/// ("Camera.fx" or "Camera1.fx" keys, with or without OpenCV's first line), of which only the
/// camera is read: all other keys are for that programme.
Result<Camera> load_camera(const std::filesystem::path& file);

/// The camera of a sequence: `camera` if not empty, a file or the name of a preset; else
/// `sequence_dir`/camera.yaml; else the preset that the folder's name tells.
Result<Camera> find_camera(const std::filesystem::path& sequence_dir,
                           const std::string& camera = "");

}  // namespace ydd
