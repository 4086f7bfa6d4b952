// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ydd/dataset/recording.h"

namespace ydd {

/// How a layout stores its pictures.
struct PictureFileRules {
  /// This count and greater ones are "no reading" as 0 is; nothing: the camera's limits alone.
  std::optional<int> no_reading_from = {};
  /// Colour pictures are brought to this size (by areas), where they have another one.
  std::optional<std::pair<int, int>> colour_size_px = {};
};

/// Pictures that are files, PNG or JPEG: those that the entries of `recording` name.
std::shared_ptr<const PictureStore> picture_files(const Recording& recording,
                                                  const PictureFileRules& rules = {});

/// A picture in memory; `name` is what messages call it. Fails like open_colour and open_depth.
Result<ColourPicture> colour_picture(const std::string& name, std::string bytes);
Result<DepthPicture> depth_picture(const std::string& name, std::string bytes);

}  // namespace ydd
