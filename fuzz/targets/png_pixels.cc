// SPDX-License-Identifier: Apache-2.0
#include <zlib.h>

#include "support.h"
#include "targets.h"
#include "ydd/image/decode.h"

namespace ydd::fuzz {
namespace {

std::string big_endian(std::uint32_t value) {
  std::string out;
  for (unsigned shift = 32; shift > 0; shift -= 8) out += static_cast<char>(value >> (shift - 8U));
  return out;
}

std::string chunk(const std::string& kind_and_content) {
  const auto* const bytes = reinterpret_cast<const Bytef*>(kind_and_content.data());
  const auto size = static_cast<uInt>(kind_and_content.size());
  return big_endian(size - 4) + kind_and_content +
         big_endian(static_cast<std::uint32_t>(::crc32(0, bytes, size)));
}

std::string compressed(std::string_view rows) {
  uLongf size = ::compressBound(rows.size());
  std::string out(size, '\0');
  if (::compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                  reinterpret_cast<const Bytef*>(rows.data()), rows.size(), 1) != Z_OK) {
    broken("zlib does not compress");
  }
  return out.substr(0, size);
}

}  // namespace

// Width, height, bits, colour type, interlacing, a palette; then what stands in the rows, in two
// chunks. Checksums are right, which keeps a fuzzer out otherwise.
void png_pixels(std::string_view input) {
  Pieces pieces(input);
  std::string header = "IHDR" + big_endian(pieces.byte()) + big_endian(pieces.byte());
  for (const unsigned largest : {16U, 7U}) {
    header += static_cast<char>(pieces.byte() % (largest + 1));
  }
  header += std::string(2, '\0') + static_cast<char>(pieces.byte() % 2);
  const std::string palette(pieces.text(pieces.byte()));
  const std::string pixels = compressed(pieces.text(input.size()));
  const std::size_t half = pixels.size() / 2;
  std::string file = "\x89PNG\r\n\x1a\n" + chunk(header);
  if (!palette.empty()) file += chunk("PLTE" + palette);
  file +=
      chunk("IDAT" + pixels.substr(0, half)) + chunk("IDAT" + pixels.substr(half)) + chunk("IEND");
  png(file);
}

}  // namespace ydd::fuzz
