// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "ydd/base/result.h"

namespace ydd {

/// What an image file says about itself before any pixel is decoded.
struct ImageHeader {
  enum class Format { png, jpeg };
  Format format = Format::png;
  int width_px = 0;
  int height_px = 0;
  int bits_per_channel = 0;
  int channels = 0;  ///< as stored: 1 grey or palette, 3 colour, 2 and 4 with alpha (PNG) or CMYK
  bool palette = false;     ///< PNG: samples are indices of a palette
  bool interlaced = false;  ///< PNG: pixels come in seven passes (Adam7)
};

/// Reads the header of a PNG or JPEG file held in `bytes` and checks that the file goes on to its
/// end marker and that its size is plausible: at most 16384 pixels a side and 2^26 in all, and no
/// more than so many bytes can hold. Who decodes after that takes no memory for a lie.
/// Failure: the reason only ("is truncated ..."); the caller names the file.
Result<ImageHeader> read_image_header(std::string_view bytes);

}  // namespace ydd
