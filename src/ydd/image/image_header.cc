// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/image_header.h"

#include <cstdint>
#include <optional>

#include <fmt/format.h>

#include "ydd/image/image_kind.h"

namespace ydd {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kPngSignatureSize = 8;
constexpr std::string_view kJpegEnd = "\xff\xd9"sv;
constexpr std::int64_t kMaxSide_px = 16384;  // a larger one is a broken header, not a camera
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 26;
constexpr std::int64_t kMaxDeflateRatio = 1032;  // deflate cannot compress better
// Huffman codes have at least one bit for each block of 64 pixels, which makes 512; arithmetic
// coding gets below that for flat pictures only.
constexpr std::int64_t kMaxJpegPixelsPerByte = 1024;

const Error kTruncated{"is truncated; copy or download it again"};

/// Big-endian number of `size` bytes; nothing beyond the end.
std::optional<std::uint32_t> number_at(std::string_view bytes, std::size_t at, std::size_t size) {
  if (at > bytes.size() || bytes.size() - at < size) return std::nullopt;
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value = (value << 8) | static_cast<std::uint8_t>(bytes[at + i]);
  }
  return value;
}

struct Size {
  std::int64_t width_px;
  std::int64_t height_px;
};

/// A failure unless a camera's picture has that size and `file_size` bytes can hold it.
Result<Size> checked(const Size& size, std::size_t file_size, std::int64_t max_pixels_per_byte) {
  const auto [width, height] = size;
  if (width < 1 || height < 1) {
    return Error{fmt::format("has a broken header (size {}x{})", width, height)};
  }
  if (width > kMaxSide_px || height > kMaxSide_px || width * height > kMaxPixels) {
    return Error{fmt::format(
        "has a broken header (size {}x{}; at most {} pixels a side and {} million in all are read)",
        width, height, kMaxSide_px, kMaxPixels / 1'000'000)};
  }
  if (width * height > static_cast<std::int64_t>(file_size) * max_pixels_per_byte) {
    return Error{fmt::format(
        "has a broken header (size {}x{}, which {} bytes cannot hold: at most {} pixels a byte)",
        width, height, file_size, max_pixels_per_byte)};
  }
  return size;
}

/// True if the chunks (length, type, data, checksum) lead to the end chunk within the file.
bool png_is_complete(std::string_view bytes) {
  std::size_t at = kPngSignatureSize;
  while (const auto length = number_at(bytes, at, 4)) {
    const std::size_t next = at + 12 + *length;
    if (next > bytes.size()) return false;
    if (bytes.substr(at + 4, 4) == "IEND") return true;
    at = next;
  }
  return false;
}

/// PNG specification, table 11.1.
bool is_png_kind(std::uint32_t colour_type, std::uint32_t bits) {
  const bool is_packed = bits == 1 || bits == 2 || bits == 4;
  switch (colour_type) {
    case 0:
      return is_packed || bits == 8 || bits == 16;
    case 3:
      return is_packed || bits == 8;
    case 2:
    case 4:
    case 6:
      return bits == 8 || bits == 16;
    default:
      return false;
  }
}

// PNG specification, 11.2.2: the first chunk is IHDR.
Result<ImageHeader> read_png(std::string_view bytes) {
  const auto width = number_at(bytes, 16, 4);
  const auto height = number_at(bytes, 20, 4);
  const auto bits = number_at(bytes, 24, 1);
  const auto colour_type = number_at(bytes, 25, 1);
  const auto methods = number_at(bytes, 26, 2);  // of compression and filtering
  const auto interlacing = number_at(bytes, 28, 1);
  if (!interlacing) return kTruncated;
  if (bytes.substr(12, 4) != "IHDR") return Error{"has a broken PNG header"};
  if (!is_png_kind(*colour_type, *bits) || *methods != 0 || *interlacing > 1) {
    return Error{fmt::format("has a broken PNG header (colour type {}, {} bits, methods {}, {})",
                             *colour_type, *bits, *methods, *interlacing)};
  }
  constexpr std::uint32_t kColour = 2;
  constexpr std::uint32_t kPalette = 3;
  constexpr std::uint32_t kAlphaBit = 4;
  ImageHeader header;
  header.format = ImageHeader::Format::png;
  header.bits_per_channel = static_cast<int>(*bits);
  header.palette = *colour_type == kPalette;
  header.interlaced = *interlacing == 1;
  header.channels = (*colour_type & kColour) && !header.palette ? 3 : 1;
  if (*colour_type & kAlphaBit) ++header.channels;
  const std::int64_t bits_per_pixel = header.channels * header.bits_per_channel;
  const auto size = checked({*width, *height}, bytes.size(), kMaxDeflateRatio * 8 / bits_per_pixel);
  if (!size) return size.error();
  if (!png_is_complete(bytes)) return kTruncated;
  header.width_px = static_cast<int>(size->width_px);
  header.height_px = static_cast<int>(size->height_px);
  return header;
}

bool is_start_of_frame(std::uint32_t marker) {
  const bool in_block = marker >= 0xC0 && marker <= 0xCF;
  return in_block && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

// ITU T.81, B.1.1: segments are FF, marker, length (with itself), data; the frame header holds
// precision, height, width and the number of components. Entropy-coded data never contains the end
// marker, but an embedded preview before the frame header may.
Result<ImageHeader> read_jpeg(std::string_view bytes) {
  std::size_t at = 2;
  while (true) {
    const auto marker = number_at(bytes, at, 2);
    const auto length = number_at(bytes, at + 2, 2);
    if (!length) return kTruncated;
    if ((*marker >> 8) != 0xFF) return Error{"has a broken JPEG header"};
    if (is_start_of_frame(*marker & 0xFF)) break;
    const bool is_fill_byte = *marker == 0xFFFF;
    at += is_fill_byte ? 1 : 2 + *length;
  }
  const auto bits = number_at(bytes, at + 4, 1);
  const auto height = number_at(bytes, at + 5, 2);
  const auto width = number_at(bytes, at + 7, 2);
  const auto channels = number_at(bytes, at + 9, 1);
  if (!channels || bytes.find(kJpegEnd, at + 10) == std::string_view::npos) return kTruncated;
  const auto size = checked({*width, *height}, bytes.size(), kMaxJpegPixelsPerByte);
  if (!size) return size.error();
  return ImageHeader{.format = ImageHeader::Format::jpeg,
                     .width_px = static_cast<int>(size->width_px),
                     .height_px = static_cast<int>(size->height_px),
                     .bits_per_channel = static_cast<int>(*bits),
                     .channels = static_cast<int>(*channels)};
}

}  // namespace

Result<ImageHeader> read_image_header(std::string_view bytes) {
  if (bytes.empty()) return Error{"is an empty file"};
  if (is_png(bytes)) return read_png(bytes);
  if (is_jpeg(bytes)) return read_jpeg(bytes);
  const auto kind = kind_of_file(bytes);
  return Error{kind ? fmt::format("is {}, neither PNG nor JPEG", *kind)
                    : "is neither PNG nor JPEG"};
}

}  // namespace ydd
