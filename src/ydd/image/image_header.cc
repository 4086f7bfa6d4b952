// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/image_header.h"

#include <cstdint>
#include <optional>

#include <fmt/format.h>

namespace ydd {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n"sv;
constexpr std::string_view kJpegSignature = "\xff\xd8\xff"sv;
constexpr std::string_view kJpegEnd = "\xff\xd9"sv;
constexpr int kMaxSide = 16384;  // a larger one is a broken header, not a camera

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

Result<ImageHeader> checked(const ImageHeader& header) {
  if (header.width_px < 1 || header.height_px < 1 || header.width_px > kMaxSide ||
      header.height_px > kMaxSide) {
    return Error{
        fmt::format("has a broken header (size {}x{})", header.width_px, header.height_px)};
  }
  return header;
}

/// True if the chunks (length, type, data, checksum) lead to the end chunk within the file.
bool png_is_complete(std::string_view bytes) {
  std::size_t at = kPngSignature.size();
  while (const auto length = number_at(bytes, at, 4)) {
    const std::size_t next = at + 12 + *length;
    if (next > bytes.size()) return false;
    if (bytes.substr(at + 4, 4) == "IEND") return true;
    at = next;
  }
  return false;
}

// PNG specification, 11.2.2: the first chunk is IHDR.
Result<ImageHeader> read_png(std::string_view bytes) {
  const auto width = number_at(bytes, 16, 4);
  const auto height = number_at(bytes, 20, 4);
  const auto bits = number_at(bytes, 24, 1);
  const auto colour = number_at(bytes, 25, 1);
  const auto interlacing = number_at(bytes, 28, 1);
  if (!interlacing) return kTruncated;
  if (bytes.substr(12, 4) != "IHDR") return Error{"has a broken PNG header"};
  if (!png_is_complete(bytes)) return kTruncated;
  ImageHeader header{.format = ImageHeader::Format::png,
                     .width_px = static_cast<int>(*width),
                     .height_px = static_cast<int>(*height),
                     .bits_per_channel = static_cast<int>(*bits)};
  constexpr std::uint32_t kPaletteBit = 1;
  constexpr std::uint32_t kColourBit = 2;
  constexpr std::uint32_t kAlphaBit = 4;
  header.channels = ((*colour & kColourBit) ? 3 : 1) + ((*colour & kAlphaBit) ? 1 : 0);
  header.plain = !(*colour & kPaletteBit) && *interlacing == 0 && *bits >= 8;
  return checked(header);
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
  return checked({.format = ImageHeader::Format::jpeg,
                  .width_px = static_cast<int>(*width),
                  .height_px = static_cast<int>(*height),
                  .bits_per_channel = static_cast<int>(*bits),
                  .channels = static_cast<int>(*channels)});
}

}  // namespace

Result<ImageHeader> read_image_header(std::string_view bytes) {
  if (bytes.empty()) return Error{"is an empty file"};
  if (bytes.starts_with(kPngSignature)) return read_png(bytes);
  if (bytes.starts_with(kJpegSignature)) return read_jpeg(bytes);
  return Error{"is neither PNG nor JPEG"};
}

}  // namespace ydd
