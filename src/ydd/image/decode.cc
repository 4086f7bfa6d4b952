// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/decode.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "ydd/base/files.h"
#include "ydd/image/image_header.h"
#include "ydd/image/image_kind.h"
#include "ydd/image/jpeg_codec.h"
#include "ydd/image/png_decoder.h"

namespace ydd {
namespace {

constexpr int kMaxCount = 65535;

Error failure(const std::filesystem::path& file, std::string_view reason) {
  return Error{fmt::format("{}: {}", file.string(), reason)};
}

/// RGB(A) or grey samples to BGR; of 16 bits the high byte, which comes first.
Result<std::vector<Bgr>> decode_png_bgr(std::string_view bytes, const ImageHeader& header) {
  const Result<PngRows> rows = decode_png(bytes, header);
  if (!rows) return rows.error();
  const ImageHeader samples = unpacked(header);
  const std::size_t pixel_size = png_pixel_size(samples);
  const std::size_t sample_size = samples.bits_per_channel == 16 ? 2 : 1;
  const std::size_t green = samples.channels >= 3 ? sample_size : 0;
  const std::size_t blue = 2 * green;
  std::vector<Bgr> pixels(std::size_t(header.width_px) * header.height_px);
  Bgr* to = pixels.data();
  for (int y = 0; y < header.height_px; ++y) {
    const std::uint8_t* from = rows->row(y);
    for (int x = 0; x < header.width_px; ++x, from += pixel_size) {
      *to++ = {from[blue], from[green], from[0]};
    }
  }
  return pixels;
}

constexpr std::string_view kDepthIsWanted =
    "a depth image is a PNG with one grey channel of 16 bits, which counts by the camera's depth "
    "scale";

int big_endian_count(const std::uint8_t* bytes) { return bytes[0] << 8 | bytes[1]; }

/// Turns counts into metres. The limits are counts too and a mask does what a condition would:
/// that is what the compiler vectorises.
class DepthScale {
 public:
  explicit DepthScale(const Camera& camera)
      : lowest_(static_cast<int>(count_within(std::ceil(camera.min_depth_m * camera.depth_scale)))),
        highest_(
            static_cast<int>(count_within(std::floor(camera.max_depth_m * camera.depth_scale)))),
        counts_per_metre_(static_cast<float>(camera.depth_scale)) {}

  float metres(int count) const {
    const int mask = -static_cast<int>((count >= lowest_) & (count <= highest_));
    return static_cast<float>(count & mask) / counts_per_metre_;
  }

 private:
  static double count_within(double limit) { return std::clamp(limit, 0.0, kMaxCount + 1.0); }

  int lowest_;
  int highest_;
  float counts_per_metre_;
};

}  // namespace

Result<ImageFile> open_colour(const std::filesystem::path& file) {
  Result<std::string> bytes = read_file(file);
  if (!bytes) return bytes.error();
  return open_colour(file, *std::move(bytes));
}

Result<ImageFile> open_depth(const std::filesystem::path& file) {
  Result<std::string> bytes = read_file(file);
  if (!bytes) return bytes.error();
  return open_depth(file, *std::move(bytes));
}

Result<ImageFile> open_colour(const std::filesystem::path& file, std::string bytes) {
  const Result<ImageHeader> header = read_image_header(bytes);
  if (!header) return failure(file, header.error().message);
  if (header->format == ImageHeader::Format::jpeg && header->bits_per_channel != 8) {
    return failure(file,
                   fmt::format("is {}; of JPEG only 8 bits a channel are read", describe(*header)));
  }
  return ImageFile{file, std::move(bytes), *header};
}

Result<ImageFile> open_depth(const std::filesystem::path& file, std::string bytes) {
  if (!bytes.empty() && !is_png(bytes) && !is_jpeg(bytes)) {
    const std::string_view kind = kind_of_file(bytes).value_or("neither PNG nor JPEG");
    return failure(file, fmt::format("is {}; {}", kind, kDepthIsWanted));
  }
  const Result<ImageHeader> header = read_image_header(bytes);
  if (!header) return failure(file, header.error().message);
  if (header->format != ImageHeader::Format::png || header->bits_per_channel != 16 ||
      header->channels != 1) {
    return failure(file, fmt::format("is {}; {}", describe(*header), kDepthIsWanted));
  }
  return ImageFile{file, std::move(bytes), *header};
}

Result<ColourImage> decode_colour(const ImageFile& file) {
  auto pixels = file.header.format == ImageHeader::Format::jpeg
                    ? decode_jpeg(file.bytes, file.header)
                    : decode_png_bgr(file.bytes, file.header);
  if (!pixels) return failure(file.path, pixels.error().message);
  return ColourImage(file.header.width_px, file.header.height_px, *std::move(pixels));
}

// The same as to_metres(load_raw_depth(...)) without the image in between.
Result<DepthImage> decode_depth(const ImageFile& file, const Camera& camera) {
  const Result<PngRows> rows = decode_png(file.bytes, file.header);
  if (!rows) return failure(file.path, rows.error().message);
  const DepthScale scale(camera);
  const auto width = static_cast<std::size_t>(file.header.width_px);
  std::vector<float> depth_m(width * file.header.height_px);
  for (int y = 0; y < file.header.height_px; ++y) {
    const std::uint8_t* const from = rows->row(y);
    float* const to = depth_m.data() + y * width;
    for (std::size_t x = 0; x < width; ++x) to[x] = scale.metres(big_endian_count(from + 2 * x));
  }
  return DepthImage(file.header.width_px, file.header.height_px, std::move(depth_m));
}

Result<ColourImage> load_colour(const std::filesystem::path& file) {
  const Result<ImageFile> opened = open_colour(file);
  if (!opened) return opened.error();
  return decode_colour(*opened);
}

Result<DepthImage> load_depth(const std::filesystem::path& file, const Camera& camera) {
  const Result<ImageFile> opened = open_depth(file);
  if (!opened) return opened.error();
  return decode_depth(*opened, camera);
}

Result<RawDepthImage> load_raw_depth(const std::filesystem::path& file) {
  const Result<ImageFile> opened = open_depth(file);
  if (!opened) return opened.error();
  return decode_raw_depth(*opened);
}

Result<RawDepthImage> decode_raw_depth(const ImageFile& file) {
  const ImageHeader& header = file.header;
  const Result<PngRows> rows = decode_png(file.bytes, header);
  if (!rows) return failure(file.path, rows.error().message);
  const auto width = static_cast<std::size_t>(header.width_px);
  std::vector<std::uint16_t> counts(width * header.height_px);
  for (int y = 0; y < header.height_px; ++y) {
    const std::uint8_t* const from = rows->row(y);
    std::uint16_t* const to = counts.data() + y * width;
    for (std::size_t x = 0; x < width; ++x) {
      to[x] = static_cast<std::uint16_t>(big_endian_count(from + 2 * x));
    }
  }
  return RawDepthImage(header.width_px, header.height_px, std::move(counts));
}

DepthImage to_metres(const RawDepthImage& raw, const Camera& camera) {
  const DepthScale scale(camera);
  const std::size_t n = std::size_t(raw.width()) * raw.height();
  std::vector<float> depth_m(n);
  const std::uint16_t* const from = raw.data();
  float* const to = depth_m.data();
  for (std::size_t i = 0; i < n; ++i) to[i] = scale.metres(from[i]);
  return {raw.width(), raw.height(), std::move(depth_m)};
}

DepthImage within_limits(const DepthImage& depth_m, const Camera& camera) {
  const std::size_t n = std::size_t(depth_m.width()) * depth_m.height();
  const float* const pixels = depth_m.data();
  const auto is_reading = [&](float z) {
    return std::isfinite(z) && z > 0 && camera.is_valid_depth(z);
  };
  const bool stays = std::all_of(pixels, pixels + n, [&](float z) {
    return is_reading(z) || std::bit_cast<std::uint32_t>(z) == 0;
  });
  if (stays) return depth_m;  // shared
  std::vector<float> out(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (is_reading(pixels[i])) out[i] = pixels[i];
  }
  return {depth_m.width(), depth_m.height(), std::move(out)};
}

RawDepthImage to_raw_depth(const DepthImage& depth_m, double depth_scale) {
  const std::size_t n = std::size_t(depth_m.width()) * depth_m.height();
  std::vector<std::uint16_t> counts(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double count = std::round(static_cast<double>(depth_m.data()[i]) * depth_scale);
    if (count > 0 && count <= kMaxCount) counts[i] = static_cast<std::uint16_t>(count);
  }
  return {depth_m.width(), depth_m.height(), std::move(counts)};
}

GreyImage to_grey(const ColourImage& colour) {
  // Fixed point with 15 bits; a plain loop over fixed offsets is what the compiler vectorises.
  constexpr unsigned kBlue = 3735;
  constexpr unsigned kGreen = 19235;
  constexpr unsigned kRed = 9798;
  static_assert(kBlue + kGreen + kRed == 1U << 15U);
  const std::size_t n = std::size_t(colour.width()) * colour.height();
  std::vector<std::uint8_t> grey(n);
  const Bgr* const from = colour.data();
  std::uint8_t* const to = grey.data();
  for (std::size_t i = 0; i < n; ++i) {
    const unsigned sum = from[i][0] * kBlue + from[i][1] * kGreen + from[i][2] * kRed;
    to[i] = static_cast<std::uint8_t>((sum + (1U << 14U)) >> 15U);
  }
  return {colour.width(), colour.height(), std::move(grey)};
}

}  // namespace ydd
