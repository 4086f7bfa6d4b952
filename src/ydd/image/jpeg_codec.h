// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/image/image.h"
#include "ydd/image/image_header.h"

namespace ydd {

/// The pixels of a JPEG file, row by row; grey becomes three equal channels.
///
/// `header` is what read_image_header gave for `bytes`. Data that makes the decoder lose its
/// place is a failure (JPEG has no checksum: a changed byte may pass), a few stray bytes before a
/// marker (some webcams) are not. Failure: the reason only; the
/// caller names the file.
Result<std::vector<Bgr>> decode_jpeg(std::string_view bytes, const ImageHeader& header);

/// A JPEG file of `image` (not empty) with chroma at half resolution; `quality` from 1 to 100.
/// Failure: the reason only.
Result<std::string> encode_jpeg(const ColourImage& image, int quality);

}  // namespace ydd
