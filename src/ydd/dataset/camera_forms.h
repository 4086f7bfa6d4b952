// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ydd/base/result.h"

namespace ydd {

/// A value of a camera under the key of Camera::describe, and where the file gives it.
struct GivenValue {
  std::string key;     ///< ours: "fx"
  std::string theirs;  ///< as the file calls it: "Camera1.fx"
  std::string text;
  std::string source;  ///< "file:line"
};

/// A camera as a file gives it, before its values are read and checked.
struct GivenCamera {
  std::vector<GivenValue> values;
  /// Baseline of the stereo pair times focal length (key "bf"), of ORB-SLAM and its relatives.
  std::vector<GivenValue> bf_px_m;
};

/// Tells by its keys which form the file has and finds the camera's values in it. Refused with one
/// line are a form that is not known, one that lacks a value, lenses of another model than pinhole
/// with radial-tangential distortion (fisheye, omnidirectional, rational with k4 to k6 not zero),
/// and a file of several cameras. `depth_scale`: counts of a metre where the file does not say it.
Result<GivenCamera> read_camera_form(const std::filesystem::path& file,
                                     std::optional<double> depth_scale = {});

}  // namespace ydd
