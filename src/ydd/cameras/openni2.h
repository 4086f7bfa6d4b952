// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/cameras/camera_modes.h"
#include "ydd/dataset/live_stream.h"
#include "ydd/geometry/camera.h"

/// Cameras through OpenNI2 (https://structure.io/openni): Orbbec Astra, Asus Xtion, PrimeSense, and
/// what else has a driver for it. Without the library, every function says so in one line.
namespace ydd {

/// A device that is plugged in.
struct CameraDevice {
  std::string uri;                        ///< names it
  std::string name;                       ///< "Orbbec Astra"
  std::vector<CameraMode> colour, depth;  ///< modes that are read: RGB, millimetres
  bool registers = false;                 ///< it can lay depth over colour
  std::string problem;                    ///< why the modes are not known; empty: they are
};

/// Those that are plugged in.
Result<std::vector<CameraDevice>> list_openni2_cameras();

/// A device that gives pictures.
struct OpenedCamera {
  std::shared_ptr<LiveStream> stream;
  std::string name;
  Result<Camera> camera;  ///< by the field of view that the device tells, without distortion
};

/// Starts the camera of this URI (empty: the first one there is): depth registered to colour,
/// nothing mirrored, both streams in step where the device can do that. `mode`: choose_camera_mode.
/// Pictures farther apart than `max_difference_s` are no pair.
Result<OpenedCamera> open_openni2_camera(const std::string& uri, const std::string& mode,
                                         double max_difference_s);

}  // namespace ydd
