// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ydd/base/result.h"
#include "ydd/image/image.h"

/// Pixels to image files, written beside `file` and renamed: readers never see half an image. All
/// functions may be called from any thread; none prints. Failures are one line that starts with the
/// file.
namespace ydd {

/// Without loss; depth has 16 bits.
Result<void> write_png(const std::filesystem::path& file, const ColourImage& image);
/// One channel of 8 bits; as the others, the file is there whole or not at all.
Result<void> write_png(const std::filesystem::path& file, const GreyImage& image);
/// Counts of depth, 16 bits.
Result<void> write_png(const std::filesystem::path& file, const RawDepthImage& image);

/// `quality` from 1 to 100, chroma at half resolution.
/// @throws std::logic_error if it is out of range.
Result<void> write_jpeg(const std::filesystem::path& file, const ColourImage& image,
                        int quality = 90);

}  // namespace ydd
