// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "ydd/base/result.h"
#include "ydd/dataset/recording.h"
#include "ydd/geometry/camera.h"

namespace ydd {

/// Reads a camera from YAML or JSON: ours (the keys of Camera::describe; width, height, fx, fy, cx
/// and cy must be there, the rest has defaults), a settings file of ORB-SLAM2, ORB-SLAM3, OpenVSLAM
/// or stella_vslam for an RGB-D camera, of which only the camera is read, or a calibration of ROS,
/// OpenCV, kalibr, camodocal, Open3D or RealSense, to which `depth_scale` must have been added:
/// these do not say how depth is stored. Where the recording tells it, `depth_scale` is taken when
/// the file does not say it. One line says why a file is refused.
Result<Camera> load_camera(const std::filesystem::path& file,
                           std::optional<double> depth_scale = {});

/// The camera of a sequence: `camera` if not empty, a file or the name of a preset; else
/// `sequence_dir`/camera.yaml; else `own_camera`, the recording's; else the preset that the
/// folder's name tells.
Result<Camera> find_camera(const std::filesystem::path& sequence_dir,
                           const std::string& camera = "",
                           const std::optional<Result<Camera>>& own_camera = {});

/// The same of a recording. A depth scale in a file that is not the format's is warned of; that of
/// a preset gives way to the format's.
Result<Camera> find_camera(const Recording& recording, const std::string& camera = "");

}  // namespace ydd
