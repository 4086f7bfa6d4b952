// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "ydd/geometry/camera.h"

namespace ydd {

/// The cameras that need no file: tum_fr1, tum_fr2, tum_fr3, bonn, office. The same values as
/// configs/camera/*.yaml, compiled in so that the program works from anywhere.
const std::vector<Camera>& camera_presets();

/// The preset of that name.
std::optional<Camera> camera_preset(std::string_view name);

/// The preset that a folder name tells ("rgbd_dataset_freiburg1_xyz", "tum_fr3_walking",
/// "rgbd_bonn_crowd", "office_room_loop"), whatever its case.
std::optional<Camera> camera_preset_of_folder(std::string_view folder_name);

}  // namespace ydd
