// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/png_decoder.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>

namespace ydd {
namespace {

// Why not libpng: inflating by libdeflate takes a third of the time, which for the depth images of
// a recording is what decoding costs, and nothing is printed behind our back.

constexpr std::size_t kSignatureSize = 8;
constexpr std::size_t kMaxRatio = 1032;  // deflate cannot compress better

const Error kDamaged{"is damaged; copy or download it again"};

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value = (value << 8) | static_cast<std::uint8_t>(bytes[at + i]);
  }
  return value;
}

/// The compressed stream: the data of all IDAT chunks, joined. Nothing if a checksum is wrong.
/// That the chunks lie within the file is known from read_image_header.
std::optional<std::string> compressed_stream(std::string_view bytes) {
  std::string stream;
  stream.reserve(bytes.size());
  for (std::size_t at = kSignatureSize;;) {
    const std::size_t length = number_at(bytes, at);
    const std::string_view type = bytes.substr(at + 4, 4);
    const std::string_view type_and_data = bytes.substr(at + 4, length + 4);
    const std::uint32_t checksum = number_at(bytes, at + 8 + length);
    if (libdeflate_crc32(0, type_and_data.data(), type_and_data.size()) != checksum) {
      return std::nullopt;
    }
    if (type == "IDAT") stream += bytes.substr(at + 8, length);
    if (type == "IEND") return stream;
    at += 12 + length;
  }
}

bool inflate(std::string_view stream, std::vector<std::uint8_t>& out) {
  struct Free {
    void operator()(libdeflate_decompressor* d) const { libdeflate_free_decompressor(d); }
  };
  const std::unique_ptr<libdeflate_decompressor, Free> decompressor(
      libdeflate_alloc_decompressor());
  // Without a place for the actual size, any other size than out.size() is a failure.
  return decompressor &&
         libdeflate_zlib_decompress(decompressor.get(), stream.data(), stream.size(), out.data(),
                                    out.size(), nullptr) == LIBDEFLATE_SUCCESS;
}

int paeth(int left, int up, int up_left) {
  const int to_left = std::abs(up - up_left);
  const int to_up = std::abs(left - up_left);
  const int to_up_left = std::abs(left + up - 2 * up_left);
  int nearest = to_up <= to_up_left ? up : up_left;
  if (to_left <= to_up && to_left <= to_up_left) nearest = left;
  return nearest;
}

/// Undoes, in place, a filter whose prediction looks at the pixel to the left: a chain over the
/// row, kept in registers, one per byte of a pixel.
template <std::size_t kBytes, class Predict>
void unfilter_chain(const std::uint8_t* up, std::uint8_t* row, std::size_t size, Predict predict) {
  std::array<int, kBytes> left{};
  std::array<int, kBytes> up_left{};
  for (std::size_t i = 0; i < size; i += kBytes) {
    for (std::size_t b = 0; b < kBytes; ++b) {
      const int above = up[i + b];
      left[b] = (row[i + b] + predict(left[b], above, up_left[b])) & 0xFF;
      up_left[b] = above;
      row[i + b] = static_cast<std::uint8_t>(left[b]);
    }
  }
}

/// PNG specification, 9.2. `up` is the row above, zeros for the first. False: no such filter.
template <std::size_t kBytes>
bool unfilter_row(int filter, const std::uint8_t* up, std::uint8_t* row, std::size_t size) {
  switch (filter) {
    case 0:
      return true;
    case 1:
      unfilter_chain<kBytes>(up, row, size, [](int left, int, int) { return left; });
      return true;
    case 2:
      for (std::size_t i = 0; i < size; ++i) row[i] = static_cast<std::uint8_t>(row[i] + up[i]);
      return true;
    case 3:
      unfilter_chain<kBytes>(up, row, size,
                             [](int left, int above, int) { return (left + above) / 2; });
      return true;
    case 4:
      unfilter_chain<kBytes>(up, row, size, paeth);
      return true;
    default:
      return false;
  }
}

template <std::size_t kBytes>
bool unfilter(PngRows& rows) {
  const std::vector<std::uint8_t> zeros(rows.row_size);
  const std::uint8_t* up = zeros.data();
  const std::size_t stride = rows.row_size + 1;
  for (std::size_t at = 0; at < rows.bytes.size(); at += stride) {
    std::uint8_t* const row = rows.bytes.data() + at + 1;
    if (!unfilter_row<kBytes>(rows.bytes[at], up, row, rows.row_size)) return false;
    up = row;
  }
  return true;
}

bool unfilter(PngRows& rows, std::size_t pixel_size) {
  switch (pixel_size) {
    case 1:
      return unfilter<1>(rows);
    case 2:
      return unfilter<2>(rows);
    case 3:
      return unfilter<3>(rows);
    case 4:
      return unfilter<4>(rows);
    case 6:
      return unfilter<6>(rows);
    default:
      return unfilter<8>(rows);
  }
}

}  // namespace

Result<PngRows> decode_png(std::string_view bytes, const ImageHeader& header) {
  if (!header.plain) {
    return Error{"is an interlaced or palette PNG; convert it to a plain one"};
  }
  const auto stream = compressed_stream(bytes);
  if (!stream) return kDamaged;
  const auto pixel_size =
      static_cast<std::size_t>(header.channels) * (header.bits_per_channel == 16 ? 2 : 1);
  PngRows rows;
  rows.row_size = static_cast<std::size_t>(header.width_px) * pixel_size;
  const std::size_t size = static_cast<std::size_t>(header.height_px) * (rows.row_size + 1);
  if (size / kMaxRatio > stream->size()) return kDamaged;  // before allocating for it
  rows.bytes.resize(size);
  if (!inflate(*stream, rows.bytes) || !unfilter(rows, pixel_size)) return kDamaged;
  return rows;
}

}  // namespace ydd
