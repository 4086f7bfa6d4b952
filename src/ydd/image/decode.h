// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "ydd/base/result.h"
#include "ydd/geometry/camera.h"
#include "ydd/image/encode.h"  // IWYU pragma: export
#include "ydd/image/image.h"
#include "ydd/image/image_header.h"

/// Image files to pixels, and what every frame needs done to them. All functions may be called from
/// any thread; none prints. Failures are one line that starts with the file.
namespace ydd {

/// A file in memory of which the header is read and found plausible, and no pixel yet: its size is
/// known before memory is taken for it.
struct ImageFile {
  std::filesystem::path path;  ///< where it is, for messages
  std::string bytes;           ///< all of the file
  ImageHeader header;          ///< its kind, size and depth of colour
};

/// Any PNG, or a JPEG with 8 bits a channel.
Result<ImageFile> open_colour(const std::filesystem::path& file);

/// A PNG with one grey channel of 16 bits, interlaced or not.
Result<ImageFile> open_depth(const std::filesystem::path& file);

/// The same of pictures that are in memory already; `name` is what errors call them.
Result<ImageFile> open_colour(const std::filesystem::path& name, std::string bytes);
/// A PNG with one grey channel of 16 bits.
Result<ImageFile> open_depth(const std::filesystem::path& name, std::string bytes);

/// As BGR; grey files get three equal channels, of 16 bits the higher 8 are kept, alpha and
/// transparency are dropped, an orientation tag is ignored (calibration is about pixels as stored).
Result<ColourImage> decode_colour(const ImageFile& file);

/// In metres, by the camera's scale; readings outside its limits become 0. `file` is from
/// open_depth.
Result<DepthImage> decode_depth(const ImageFile& file, const Camera& camera);

/// The counts of `file`, which is from open_depth.
Result<RawDepthImage> decode_raw_depth(const ImageFile& file);

/// open_colour and decode_colour.
Result<ColourImage> load_colour(const std::filesystem::path& file);

/// open_depth and decode_raw_depth.
Result<RawDepthImage> load_raw_depth(const std::filesystem::path& file);

/// open_depth and decode_depth.
Result<DepthImage> load_depth(const std::filesystem::path& file, const Camera& camera);

/// Counts to metres; readings outside the camera's limits become 0.
DepthImage to_metres(const RawDepthImage& raw, const Camera& camera);

/// Metres with the camera's limits: what is outside of them or not finite becomes 0. Shares the
/// pixels where nothing is.
DepthImage within_limits(const DepthImage& depth_m, const Camera& camera);

/// Metres to the nearest count; what a count cannot hold (over 65535, negative, not finite)
/// becomes 0.
RawDepthImage to_raw_depth(const DepthImage& depth_m, double depth_scale);

/// Luma by ITU-R BT.601 (0.299 R + 0.587 G + 0.114 B), rounded to nearest.
GreyImage to_grey(const ColourImage& colour);

}  // namespace ydd
