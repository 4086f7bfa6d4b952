// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/encode.h"

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "ydd/base/files.h"
#include "ydd/image/jpeg_codec.h"
#include "ydd/image/png_encoder.h"

namespace ydd {
namespace {

/// `store(pixel, to)` writes the bytes of a pixel as PNG wants them.
template <class T, class Store>
Result<void> write_rows(const std::filesystem::path& file, const Image<T>& image, int channels,
                        int bits, Store store) {
  if (image.empty()) return Error{fmt::format("{}: an empty image has no file", file.string())};
  const auto pixel_size = static_cast<std::size_t>(channels * bits / 8);
  PngRows rows;
  rows.row_size = static_cast<std::size_t>(image.width()) * pixel_size;
  rows.bytes.resize(static_cast<std::size_t>(image.height()) * (rows.row_size + 1));
  std::uint8_t* to = rows.bytes.data();
  for (int y = 0; y < image.height(); ++y) {
    ++to;  // the filter's
    for (int x = 0; x < image.width(); ++x, to += pixel_size) store(image(x, y), to);
  }
  ImageHeader header;
  header.width_px = image.width();
  header.height_px = image.height();
  header.bits_per_channel = bits;
  header.channels = channels;
  return write_file_atomically(file, encode_png(rows, header));
}

}  // namespace

Result<void> write_png(const std::filesystem::path& file, const ColourImage& image) {
  return write_rows(file, image, 3, 8, [](const Bgr& bgr, std::uint8_t* to) {
    to[0] = bgr[2];
    to[1] = bgr[1];
    to[2] = bgr[0];
  });
}

Result<void> write_png(const std::filesystem::path& file, const GreyImage& image) {
  return write_rows(file, image, 1, 8, [](std::uint8_t grey, std::uint8_t* to) { *to = grey; });
}

Result<void> write_png(const std::filesystem::path& file, const RawDepthImage& image) {
  return write_rows(file, image, 1, 16, [](std::uint16_t count, std::uint8_t* to) {
    to[0] = static_cast<std::uint8_t>(count >> 8U);
    to[1] = static_cast<std::uint8_t>(count);
  });
}

Result<void> write_jpeg(const std::filesystem::path& file, const ColourImage& image, int quality) {
  if (quality < 1 || quality > 100) throw std::logic_error("write_jpeg: quality out of range");
  if (image.empty()) return Error{fmt::format("{}: an empty image has no file", file.string())};
  const Result<std::string> bytes = encode_jpeg(image, quality);
  if (!bytes) return Error{fmt::format("{}: {}", file.string(), bytes.error().message)};
  return write_file_atomically(file, *bytes);
}

}  // namespace ydd
