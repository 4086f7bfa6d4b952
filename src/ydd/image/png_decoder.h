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

/// The samples of a PNG file. `header` is what read_image_header gave for `bytes`; 8 or 16 bits a
/// sample. Every checksum is verified. Colour correction and transparency chunks are ignored: a
/// camera's images are data. Failure: the reason only; the caller names the file.
/// Source: PNG specification (ISO/IEC 15948).
Result<PngRows> decode_png(std::string_view bytes, const ImageHeader& header);

}  // namespace ydd
