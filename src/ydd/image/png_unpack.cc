// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/png_unpack.h"

#include <algorithm>
#include <array>

namespace ydd {
namespace {

// PNG specification, 8.2 (Adam7).
constexpr std::array<PngPass, 7> kAdam7 = {{{0, 0, 8, 8},
                                            {4, 0, 8, 8},
                                            {0, 4, 4, 8},
                                            {2, 0, 4, 4},
                                            {0, 2, 2, 4},
                                            {1, 0, 2, 2},
                                            {0, 1, 1, 2}}};

int pixels_of_pass(int size, int first, int step) { return (size - first + step - 1) / step; }

/// Pixels of a file to pixels of PngRows.
class Unpacker {
 public:
  Unpacker(const ImageHeader& header, std::string_view palette)
      : bits_(static_cast<unsigned>(header.bits_per_channel)),
        is_palette_(header.palette),
        palette_(palette),
        pixel_size_(png_pixel_size(unpacked(header))) {}

  std::size_t pixel_size() const { return pixel_size_; }

  /// Pixel `x` of a row of a pass. False: its colour is not in the palette.
  bool unpack(const std::uint8_t* row, std::size_t x, std::uint8_t* to) const {
    if (bits_ >= 8 && !is_palette_) {
      std::copy_n(row + x * pixel_size_, pixel_size_, to);
      return true;
    }
    const unsigned value = packed_value(row, x);
    if (!is_palette_) {
      *to = static_cast<std::uint8_t>(value * 255 / ((1U << bits_) - 1));
      return true;
    }
    if (palette_.size() < (value + 1) * pixel_size_) return false;
    std::copy_n(palette_.data() + value * pixel_size_, pixel_size_, to);
    return true;
  }

 private:
  /// The first pixel stands in the highest bits of a byte.
  unsigned packed_value(const std::uint8_t* row, std::size_t x) const {
    const std::size_t bit = x * bits_;
    const auto shift = static_cast<unsigned>(8 - bits_ - bit % 8);
    return (row[bit / 8] >> shift) & ((1U << bits_) - 1);
  }

  unsigned bits_;
  bool is_palette_;
  std::string_view palette_;
  std::size_t pixel_size_;
};

}  // namespace

ImageHeader unpacked(const ImageHeader& header) {
  ImageHeader result = header;
  result.interlaced = false;
  result.bits_per_channel = std::max(8, header.bits_per_channel);
  if (header.palette) result.channels = 3;
  result.palette = false;
  return result;
}

bool is_plain_png(const ImageHeader& header) {
  return !header.palette && !header.interlaced && header.bits_per_channel >= 8;
}

std::vector<PngPass> png_passes(const ImageHeader& header) {
  const auto bits = static_cast<std::size_t>(header.bits_per_channel * header.channels);
  const std::array<PngPass, 1> whole{};
  const auto schemes =
      header.interlaced ? std::span<const PngPass>(kAdam7) : std::span<const PngPass>(whole);
  std::vector<PngPass> passes;
  for (PngPass pass : schemes) {
    pass.width_px = pixels_of_pass(header.width_px, pass.first_x, pass.step_x);
    pass.height_px = pixels_of_pass(header.height_px, pass.first_y, pass.step_y);
    pass.row_size = (static_cast<std::size_t>(pass.width_px) * bits + 7) / 8;
    if (pass.width_px > 0 && pass.height_px > 0) passes.push_back(pass);
  }
  return passes;
}

std::optional<PngRows> unpack_png(std::span<const std::uint8_t> bytes,
                                  std::span<const PngPass> passes, const ImageHeader& header,
                                  std::string_view palette) {
  const Unpacker unpacker(header, palette);
  const std::size_t pixel_size = unpacker.pixel_size();
  PngRows rows;
  rows.row_size = static_cast<std::size_t>(header.width_px) * pixel_size;
  const std::size_t stride = rows.row_size + 1;
  rows.bytes.resize(static_cast<std::size_t>(header.height_px) * stride);
  const std::uint8_t* from = bytes.data();
  for (const PngPass& pass : passes) {
    for (int y = 0; y < pass.height_px; ++y, from += pass.row_size + 1) {
      const auto to_y = static_cast<std::size_t>(pass.first_y + y * pass.step_y);
      std::uint8_t* const first = rows.bytes.data() + to_y * stride + 1;
      for (int x = 0; x < pass.width_px; ++x) {
        const auto to_x = static_cast<std::size_t>(pass.first_x + x * pass.step_x);
        if (!unpacker.unpack(from + 1, static_cast<std::size_t>(x), first + to_x * pixel_size)) {
          return std::nullopt;
        }
      }
    }
  }
  return rows;
}

}  // namespace ydd
