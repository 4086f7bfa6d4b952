// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "ydd/image/image_header.h"
#include "ydd/image/png_decoder.h"

namespace ydd {

/// One pass over the picture: every step_x-th pixel of every step_y-th row from (first_x, first_y)
/// on. A picture that is not interlaced has one, of all pixels.
struct PngPass {
  int first_x = 0;
  int first_y = 0;
  int step_x = 1;
  int step_y = 1;
  int width_px = 0;          ///< pixels in a row of the pass
  int height_px = 0;         ///< rows of the pass
  std::size_t row_size = 0;  ///< bytes of a row, without that of the filter

  std::size_t size() const { return static_cast<std::size_t>(height_px) * (row_size + 1); }
};

/// The passes in the order of the file; empty ones are left out, as in the file.
std::vector<PngPass> png_passes(const ImageHeader& header);

/// True if the only pass of the file is what decode_png gives: nothing to unpack.
bool is_plain_png(const ImageHeader& header);

/// Rows of whole samples from the unfiltered `passes`, which stand one behind the other in
/// `bytes`: interlacing undone, 1, 2 and 4 bits of grey stretched to 8, indices replaced by the
/// colours of `palette` (three bytes each: red, green, blue). Nothing if an index has no colour.
std::optional<PngRows> unpack_png(std::span<const std::uint8_t> bytes,
                                  std::span<const PngPass> passes, const ImageHeader& header,
                                  std::string_view palette);

}  // namespace ydd
