// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ydd/image/image_header.h"
#include "ydd/image/png_decoder.h"

namespace ydd {

/// A PNG file of `rows`, whose filter bytes may hold anything. `header` tells size, channels (1 or
/// 3) and bits (8 or 16). Source: PNG specification (ISO/IEC 15948).
/// @throws std::bad_alloc if memory runs out.
std::string encode_png(const PngRows& rows, const ImageHeader& header);

}  // namespace ydd
