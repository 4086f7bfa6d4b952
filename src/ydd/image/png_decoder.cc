// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/png_decoder.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>

#include "ydd/image/png_unpack.h"

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

struct Content {
  std::string stream;        ///< compressed: the data of all IDAT chunks, joined
  std::string_view palette;  ///< of PLTE; empty without one
};

/// Nothing if a checksum is wrong.
/// That the chunks lie within the file is known from read_image_header.
std::optional<Content> read_chunks(std::string_view bytes) {
  Content content;
  content.stream.reserve(bytes.size());
  for (std::size_t at = kSignatureSize;;) {
    const std::size_t length = number_at(bytes, at);
    const std::string_view type = bytes.substr(at + 4, 4);
    const std::string_view type_and_data = bytes.substr(at + 4, length + 4);
    const std::uint32_t checksum = number_at(bytes, at + 8 + length);
    if (libdeflate_crc32(0, type_and_data.data(), type_and_data.size()) != checksum) {
      return std::nullopt;
    }
    if (type == "IDAT") content.stream += bytes.substr(at + 8, length);
    if (type == "PLTE") content.palette = bytes.substr(at + 8, length);
    if (type == "IEND") return content;
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
bool unfilter(std::uint8_t* bytes, const PngPass& pass) {
  const std::vector<std::uint8_t> zeros(pass.row_size);
  const std::uint8_t* up = zeros.data();
  const std::size_t stride = pass.row_size + 1;
  for (std::size_t at = 0; at < pass.size(); at += stride) {
    std::uint8_t* const row = bytes + at + 1;
    if (!unfilter_row<kBytes>(bytes[at], up, row, pass.row_size)) return false;
    up = row;
  }
  return true;
}

/// `pixel_size` in bytes, 1 for pixels that are smaller.
bool unfilter(std::uint8_t* bytes, const PngPass& pass, std::size_t pixel_size) {
  switch (pixel_size) {
    case 1:
      return unfilter<1>(bytes, pass);
    case 2:
      return unfilter<2>(bytes, pass);
    case 3:
      return unfilter<3>(bytes, pass);
    case 4:
      return unfilter<4>(bytes, pass);
    case 6:
      return unfilter<6>(bytes, pass);
    default:
      return unfilter<8>(bytes, pass);
  }
}

}  // namespace

Result<PngRows> decode_png(std::string_view bytes, const ImageHeader& header) {
  const auto content = read_chunks(bytes);
  if (!content) return kDamaged;
  const std::vector<PngPass> passes = png_passes(header);
  std::size_t size = 0;
  for (const PngPass& pass : passes) size += pass.size();
  if (size / kMaxRatio > content->stream.size()) return kDamaged;  // before allocating for it
  PngRows rows;
  rows.row_size = passes.front().row_size;
  rows.bytes.resize(size);
  if (!inflate(content->stream, rows.bytes)) return kDamaged;
  const std::size_t pixel_size = header.palette ? 1 : png_pixel_size(header);
  std::uint8_t* from = rows.bytes.data();
  for (const PngPass& pass : passes) {
    if (!unfilter(from, pass, pixel_size)) return kDamaged;
    from += pass.size();
  }
  if (is_plain_png(header)) return rows;
  auto whole = unpack_png(rows.bytes, passes, header, content->palette);
  if (!whole) return Error{"has a pixel whose colour is not in its palette; copy it again"};
  return *std::move(whole);
}

}  // namespace ydd
