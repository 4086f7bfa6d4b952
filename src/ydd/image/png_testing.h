// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <libdeflate.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

/// PNG files of every kind, put together by hand for tests: independent of what is tested.
namespace ydd::testing_png {

inline std::string big_endian(std::uint32_t n) {
  return {static_cast<char>(n >> 24U), static_cast<char>(n >> 16U), static_cast<char>(n >> 8U),
          static_cast<char>(n)};
}

inline std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  return big_endian(static_cast<std::uint32_t>(data.size())) + body +
         big_endian(libdeflate_crc32(0, body.data(), body.size()));
}

inline std::string compressed(const std::string& bytes) {
  std::string stream(bytes.size() + 1000, '\0');
  auto* const compressor = libdeflate_alloc_compressor(1);
  stream.resize(libdeflate_zlib_compress(compressor, bytes.data(), bytes.size(), stream.data(),
                                         stream.size()));
  libdeflate_free_compressor(compressor);
  return stream;
}

struct Head {
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  int bits = 8;
  int colour_type = 2;  ///< 0 grey, 2 colour, 3 palette, 4 grey and alpha, 6 colour and alpha
  int interlacing = 0;
};

/// A file of `rows`, each with the byte of its filter before it; `more` are chunks before them.
inline std::string file(const Head& head, const std::string& rows, const std::string& more = "") {
  std::string header = big_endian(head.width_px) + big_endian(head.height_px);
  header += static_cast<char>(head.bits);
  header += static_cast<char>(head.colour_type);
  header += std::string(2, '\0') + static_cast<char>(head.interlacing);
  const std::string stream = compressed(rows);
  const std::size_t half = stream.size() / 2;
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + more + chunk("tEXt", "note") +
         chunk("IDAT", stream.substr(0, half)) + chunk("IDAT", stream.substr(half)) +
         chunk("IEND", "");
}

/// Sample of channel c of the pixel at (x, y).
using Samples = std::function<unsigned(int x, int y, int c)>;

/// The rows for file() with filter 1 (difference to the pixel at the left) throughout.
inline std::string rows_of(const Head& head, const Samples& samples) {
  // In which pass each pixel of an 8x8 block comes: PNG specification, 8.2.
  constexpr std::string_view kPasses =
      "1646264677777777565656567777777736463646777777775656565677777777";
  const int channels =
      std::string_view("1031204")[static_cast<std::size_t>(head.colour_type)] - '0';
  std::string rows;
  for (char pass = '1'; pass <= (head.interlacing ? '7' : '1'); ++pass) {
    for (int y = 0; y < static_cast<int>(head.height_px); ++y) {
      std::string row;
      unsigned bits = 0;
      int n_bits = 0;
      const auto put = [&](unsigned value, int size) {
        for (int bit = size - 1; bit >= 0; --bit) {
          bits = bits << 1U | ((value >> static_cast<unsigned>(bit)) & 1U);
          if (++n_bits % 8 == 0) row += static_cast<char>(bits);
        }
      };
      for (int x = 0; x < static_cast<int>(head.width_px); ++x) {
        const auto at = static_cast<std::size_t>(y % 8 * 8 + x % 8);
        if (head.interlacing && kPasses[at] != pass) continue;
        for (int c = 0; c < channels; ++c) put(samples(x, y, c), head.bits);
      }
      if (n_bits == 0) continue;
      while (n_bits % 8 != 0) put(0, 1);
      const auto left = static_cast<std::size_t>(std::max(1, head.bits * channels / 8));
      for (std::size_t i = row.size(); i-- > left;) {
        row[i] = static_cast<char>(row[i] - row[i - left]);
      }
      rows += '\1' + row;
    }
  }
  return rows;
}

}  // namespace ydd::testing_png
