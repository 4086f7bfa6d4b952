// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/dataset/recording.h"

/// Lists of pictures as the TUM benchmark has them, which others took over.
namespace ydd::sources {

/// "stamp file" lines, the files relative to `folder`. `hint` ends the error when there is no such
/// list.
Result<std::vector<PictureEntry>> read_picture_list(const std::filesystem::path& folder,
                                                    const std::string& name,
                                                    const std::string& hint);

enum class FirstPicture { colour, depth };  ///< of a line

/// "stamp file stamp file" lines. Colour stamps must increase; depth pictures may repeat.
Result<Recording> read_associations(const std::filesystem::path& folder,
                                    const std::filesystem::path& file,
                                    FirstPicture first = FirstPicture::colour);

/// groundtruth.txt, where `folder` has one: poses of the colour camera.
std::optional<GroundTruth> tum_groundtruth(const std::filesystem::path& file);

}  // namespace ydd::sources
