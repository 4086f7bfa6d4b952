// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/image/image_header.h"

namespace ydd {

/// The samples of an image as PNG stores them: grey or RGB, with alpha if the header says so,
/// 16-bit samples with their high byte first.
struct PngRows {
  std::vector<std::uint8_t> bytes;
  std::size_t row_size = 0;  ///< bytes of a row

  /// Unchecked. Each row is preceded by a byte that once named its filter.
  const std::uint8_t* row(int y) const {
    return bytes.data() + static_cast<std::size_t>(y) * (row_size + 1) + 1;
  }
};

/// The header of what decode_png gives for a file with `header`: not interlaced, three channels of
/// 8 bits instead of a palette, 8 bits a sample instead of 1, 2 or 4.
ImageHeader unpacked(const ImageHeader& header);

/// Bytes of a pixel of PngRows; `header` is an unpacked one.
inline std::size_t png_pixel_size(const ImageHeader& header) {
  return static_cast<std::size_t>(header.channels) * (header.bits_per_channel == 16 ? 2 : 1);
}

/// The samples of a PNG file of any kind, as unpacked(header) says. `header` is what
/// read_image_header gave for `bytes`. Every checksum is verified. Colour correction and
/// transparency chunks are ignored: a camera's images are data. Failure: the reason only; the
/// caller names the file. Source: PNG specification (ISO/IEC 15948).
Result<PngRows> decode_png(std::string_view bytes, const ImageHeader& header);

}  // namespace ydd
