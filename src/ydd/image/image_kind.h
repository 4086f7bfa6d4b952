// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "ydd/image/image_header.h"

/// What a file is, in words for a message: "is ..." goes before, what is expected after.
namespace ydd {

/// True if `bytes` start as a PNG or a JPEG file does.
bool is_png(std::string_view bytes);
bool is_jpeg(std::string_view bytes);

/// By its first bytes, for files that are neither PNG nor JPEG: "an OpenEXR image", "a web page".
/// Nothing if it is of no kind that people take for a picture.
std::optional<std::string_view> kind_of_file(std::string_view bytes);

/// "a grey PNG of 8 bits a channel", "an interlaced colour PNG of 8 bits a channel, with alpha".
std::string describe(const ImageHeader& header);

}  // namespace ydd
