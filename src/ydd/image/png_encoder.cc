// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/png_encoder.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <string_view>

namespace ydd {
namespace {

using namespace std::string_view_literals;

// Level 4 of libdeflate: about the size that zlib reaches by default, in a fifth of its time.
constexpr int kLevel = 4;

std::string big_endian(std::uint32_t number) {
  return {static_cast<char>(number >> 24U), static_cast<char>(number >> 16U),
          static_cast<char>(number >> 8U), static_cast<char>(number)};
}

std::string chunk(std::string_view type, std::string_view data) {
  const std::string body = std::string(type).append(data);
  return big_endian(static_cast<std::uint32_t>(data.size())) + body +
         big_endian(libdeflate_crc32(0, body.data(), body.size()));
}

/// The filters that look at one neighbour, left (1) or above (2): cheap to undo.
std::vector<std::uint8_t> filtered_row(int filter, const std::uint8_t* row, const std::uint8_t* up,
                                       std::size_t size, std::size_t pixel_size) {
  std::vector<std::uint8_t> out(size + 1);
  out[0] = static_cast<std::uint8_t>(filter);
  std::uint8_t* const to = out.data() + 1;
  if (filter == 2) {
    for (std::size_t i = 0; i < size; ++i) to[i] = static_cast<std::uint8_t>(row[i] - up[i]);
  } else {
    for (std::size_t i = 0; i < pixel_size; ++i) to[i] = row[i];
    for (std::size_t i = pixel_size; i < size; ++i) {
      to[i] = static_cast<std::uint8_t>(row[i] - row[i - pixel_size]);
    }
  }
  return out;
}

/// Sum of the differences as signed bytes: the specification's advice (12.7) for choosing a filter.
unsigned cost(const std::vector<std::uint8_t>& filtered) {
  unsigned sum = 0;
  for (std::size_t i = 1; i < filtered.size(); ++i) {
    sum += static_cast<unsigned>(std::abs(static_cast<std::int8_t>(filtered[i])));
  }
  return sum;
}

std::vector<std::uint8_t> filter_rows(const PngRows& rows, int height_px, std::size_t pixel_size) {
  std::vector<std::uint8_t> out;
  out.reserve(rows.bytes.size());
  const std::vector<std::uint8_t> zeros(rows.row_size);
  const std::uint8_t* up = zeros.data();
  for (int y = 0; y < height_px; ++y) {
    std::vector<std::uint8_t> best;
    unsigned best_cost = std::numeric_limits<unsigned>::max();
    for (const int filter : {1, 2}) {
      std::vector<std::uint8_t> row =
          filtered_row(filter, rows.row(y), up, rows.row_size, pixel_size);
      const unsigned row_cost = cost(row);
      if (row_cost >= best_cost) continue;
      best_cost = row_cost;
      best = std::move(row);
    }
    out.insert(out.end(), best.begin(), best.end());
    up = rows.row(y);
  }
  return out;
}

std::string deflate(const std::vector<std::uint8_t>& data) {
  struct Free {
    void operator()(libdeflate_compressor* c) const { libdeflate_free_compressor(c); }
  };
  const std::unique_ptr<libdeflate_compressor, Free> compressor(
      libdeflate_alloc_compressor(kLevel));
  if (!compressor) throw std::bad_alloc();
  std::string out(libdeflate_zlib_compress_bound(compressor.get(), data.size()), '\0');
  out.resize(
      libdeflate_zlib_compress(compressor.get(), data.data(), data.size(), out.data(), out.size()));
  return out;
}

}  // namespace

std::string encode_png(const PngRows& rows, const ImageHeader& header, std::string_view text) {
  const auto bytes_per_sample = static_cast<std::size_t>(header.bits_per_channel / 8);
  const std::size_t pixel_size = bytes_per_sample * static_cast<std::size_t>(header.channels);
  constexpr char kGrey = 0;
  constexpr char kRgb = 2;
  std::string head = big_endian(static_cast<std::uint32_t>(header.width_px)) +
                     big_endian(static_cast<std::uint32_t>(header.height_px));
  head += static_cast<char>(header.bits_per_channel);
  head += header.channels == 3 ? kRgb : kGrey;
  head += "\0\0\0"sv;  // deflate, adaptive filters, no interlacing
  return std::string("\x89PNG\r\n\x1a\n") + chunk("IHDR", head) +
         (text.empty() ? "" : chunk("tEXt", text)) +
         chunk("IDAT", deflate(filter_rows(rows, header.height_px, pixel_size))) +
         chunk("IEND", "");
}

std::string_view png_text(std::string_view png) {
  constexpr std::size_t kAfterHead = 8 + 12 + 13;  // signature, and the chunk IHDR
  if (png.size() < kAfterHead + 8 || png.substr(kAfterHead + 4, 4) != "tEXt") return {};
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    size = size << 8U | static_cast<std::uint8_t>(png[kAfterHead + i]);
  }
  return png.substr(kAfterHead + 8, std::min<std::size_t>(size, png.size() - kAfterHead - 8));
}

}  // namespace ydd
