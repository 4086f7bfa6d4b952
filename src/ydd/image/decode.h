// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ydd/base/result.h"
#include "ydd/geometry/camera.h"
#include "ydd/image/encode.h"  // IWYU pragma: export
#include "ydd/image/image.h"

/// Image files to pixels, and what every frame needs done to them. All functions may be called from
/// any thread; none prints. Failures are one line that starts with the file.
namespace ydd {

/// A PNG or JPEG file with 8 bits a channel, as BGR; grey files get three equal channels, alpha is
/// dropped, an orientation tag is ignored (calibration is about pixels as stored).
Result<ColourImage> load_colour(const std::filesystem::path& file);

/// A PNG file with one channel of 16 bits.
Result<RawDepthImage> load_raw_depth(const std::filesystem::path& file);

/// The same in metres, by the camera's scale; readings outside its limits become 0.
Result<DepthImage> load_depth(const std::filesystem::path& file, const Camera& camera);

/// Counts to metres; readings outside the camera's limits become 0.
DepthImage to_metres(const RawDepthImage& raw, const Camera& camera);

/// Metres to the nearest count; what a count cannot hold (over 65535, negative, not finite)
/// becomes 0.
RawDepthImage to_raw_depth(const DepthImage& depth_m, double depth_scale);

/// Luma by ITU-R BT.601 (0.299 R + 0.587 G + 0.114 B), rounded to nearest.
GreyImage to_grey(const ColourImage& colour);

}  // namespace ydd
