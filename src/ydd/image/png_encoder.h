// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ydd/image/image_header.h"
#include "ydd/image/png_decoder.h"

namespace ydd {

/// A PNG file of `rows`, whose filter bytes may hold anything. `header` tells size, channels (1 or
/// 3) and bits (8 or 16). `text`, unless empty, is a note for who looks for it: "key\0text",
/// Latin-1. Source: PNG specification (ISO/IEC 15948).
/// @throws std::bad_alloc if memory runs out.
std::string encode_png(const PngRows& rows, const ImageHeader& header, std::string_view text = {});

/// The note in a file that encode_png made; empty: there is none. Never throws, whatever the bytes.
std::string_view png_text(std::string_view png);

}  // namespace ydd
