// SPDX-License-Identifier: Apache-2.0
#include "ydd/messages/ros_pictures.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ydd/base/one_line.h"
#include "ydd/dataset/picture_files.h"
#include "ydd/image/decode.h"

namespace ydd {
namespace {

/// Where blue, green and red of a pixel are, in bytes.
struct ColourEncoding {
  std::string_view name;
  std::size_t size;  ///< of a pixel
  std::array<std::size_t, 3> bgr;
};

constexpr std::array<ColourEncoding, 8> kColours = {{{"rgb8", 3, {2, 1, 0}},
                                                     {"bgr8", 3, {0, 1, 2}},
                                                     {"rgba8", 4, {2, 1, 0}},
                                                     {"bgra8", 4, {0, 1, 2}},
                                                     {"8UC3", 3, {0, 1, 2}},
                                                     {"8UC4", 4, {0, 1, 2}},
                                                     {"mono8", 1, {0, 0, 0}},
                                                     {"8UC1", 1, {0, 0, 0}}}};
constexpr std::string_view kColoursAre = "rgb8, bgr8, rgba8, bgra8 or mono8, or JPEG or PNG";
constexpr std::string_view kDepthIs = "16UC1 or 32FC1, or compressedDepth of either as PNG";
constexpr std::uint32_t kLargestSide_px = 16384;
constexpr std::size_t kDepthHead = 12;  // bytes before the PNG of a compressedDepth

const ColourEncoding* colour_encoding(std::string_view name) {
  for (const ColourEncoding& encoding : kColours) {
    if (encoding.name == name) return &encoding;
  }
  return nullptr;
}

bool is_counts(std::string_view encoding) { return encoding == "16UC1" || encoding == "mono16"; }
bool is_metres(std::string_view encoding) { return encoding == "32FC1"; }
bool is_compressed_depth(std::string_view format) {
  return format.find("compressedDepth") != std::string_view::npos;
}

Error message_error(const StoredMessage& message, const std::string& reason) {
  return Error{fmt::format("{}: {}", message.name, reason)};
}

Error damaged(const StoredMessage& message) {
  return message_error(message, "the message is damaged");
}

/// What a text of a message says, for a line of an error.
std::string quote(std::string_view text) { return "'" + on_one_line(text.substr(0, 40)) + "'"; }

/// Whether the rows are all there.
bool has_rows(const ImageMessage& image, std::size_t pixel_size) {
  return image.width_px > 0 && image.height_px > 0 && image.width_px <= kLargestSide_px &&
         image.height_px <= kLargestSide_px && image.step >= image.width_px * pixel_size &&
         image.data.size() >= std::size_t{image.step} * image.height_px;
}

std::string rows_text(const ImageMessage& image) {
  return fmt::format("{}x{} {} with {} bytes a row does not fit {} bytes", image.width_px,
                     image.height_px, quote(image.encoding), image.step, image.data.size());
}

Result<void> check_rows(const StoredMessage& message, const ImageMessage& image,
                        std::size_t pixel_size) {
  if (!has_rows(image, pixel_size)) return message_error(message, rows_text(image));
  return {};
}

Error damaged(const ImageMessage& image) {
  return Error{"the message is damaged: " + rows_text(image)};
}

ColourImage decode_rows(const ImageMessage& image, const ColourEncoding& encoding) {
  const auto width = static_cast<int>(image.width_px), height = static_cast<int>(image.height_px);
  std::vector<Bgr> pixels(std::size_t{image.width_px} * image.height_px);
  Bgr* to = pixels.data();
  const auto [b, g, r] = encoding.bgr;
  for (std::size_t y = 0; y < image.height_px; ++y) {
    const char* from = image.data.data() + y * image.step;
    for (std::size_t x = 0; x < image.width_px; ++x, from += encoding.size) {
      *to++ = {static_cast<std::uint8_t>(from[b]), static_cast<std::uint8_t>(from[g]),
               static_cast<std::uint8_t>(from[r])};
    }
  }
  return {width, height, std::move(pixels)};
}

/// Number of type T at `from`, in the byte order of the message.
template <class T>
T number_at(const char* from, bool big_endian) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

template <class T>
Image<T> numbers_of(const ImageMessage& image) {
  std::vector<T> values;
  values.reserve(std::size_t{image.width_px} * image.height_px);
  for (std::size_t y = 0; y < image.height_px; ++y) {
    const char* const row = image.data.data() + y * image.step;
    for (std::size_t x = 0; x < image.width_px; ++x) {
      values.push_back(number_at<T>(row + x * sizeof(T), image.big_endian));
    }
  }
  return {static_cast<int>(image.width_px), static_cast<int>(image.height_px), std::move(values)};
}

/// A depth picture whose pixels `metres_of` gives in metres, whatever the camera says.
DepthPicture metric_picture(const std::string& name, int width, int height,
                            const std::function<Result<DepthImage>()>& metres_of) {
  return {name,
          width,
          height,
          [metres_of](const Camera& camera) -> Result<DepthImage> {
            const Result<DepthImage> depth_m = metres_of();
            if (!depth_m) return depth_m.error();
            return within_limits(*depth_m, camera);
          },
          [metres_of]() -> Result<RawDepthImage> {
            const Result<DepthImage> depth_m = metres_of();
            if (!depth_m) return depth_m.error();
            return to_raw_depth(*depth_m, 1000);
          },
          true};
}

Result<DepthPicture> depth_of_image(const StoredMessage& message) {
  const auto image = read_image(*message.bytes, message.wire);
  if (!image) return damaged(message);
  const bool counts = is_counts(image->encoding);
  if (!counts && !is_metres(image->encoding)) {
    return message_error(message, fmt::format("is {}; depth is {}: name its topic with "
                                              "--topic-depth",
                                              quote(image->encoding), kDepthIs));
  }
  if (auto r = check_rows(message, *image, counts ? 2 : 4); !r) return r.error();
  const auto width = static_cast<int>(image->width_px), height = static_cast<int>(image->height_px);
  // The message is read again when it is decoded: what it gives points into these bytes.
  const auto again = [bytes = message.bytes, wire = message.wire] {
    return read_image(*bytes, wire).value();
  };
  if (!counts) {
    return metric_picture(message.name, width, height,
                          [again]() -> Result<DepthImage> { return numbers_of<float>(again()); });
  }
  return DepthPicture{
      message.name, width, height,
      [again](const Camera& camera) -> Result<DepthImage> {
        return to_metres(numbers_of<std::uint16_t>(again()), camera);
      },
      [again]() -> Result<RawDepthImage> { return numbers_of<std::uint16_t>(again()); }};
}

/// a / (count - b): what compressed_depth_image_transport makes of metres, back.
DepthImage unquantised(const RawDepthImage& counts, float a, float b) {
  const std::size_t n = std::size_t(counts.width()) * counts.height();
  std::vector<float> out(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto count = static_cast<float>(counts.data()[i]);
    if (count > 0) out[i] = a / (count - b);
  }
  return {counts.width(), counts.height(), std::move(out)};
}

/// A picture that is_compressed_depth and has its head.
Result<DepthPicture> unpacked_depth(const std::string& name, const CompressedImageMessage& image) {
  if (image.format.find("rvl") != std::string_view::npos) {
    return Error{name + ": is compressedDepth as RVL; record it as png"};
  }
  Result<DepthPicture> png = depth_picture(name, std::string(image.data.substr(kDepthHead)));
  if (!png || !image.format.starts_with("32FC1")) return png;
  const auto a = number_at<float>(image.data.data() + 4, false);
  const auto b = number_at<float>(image.data.data() + 8, false);
  return metric_picture(name, png->width_px, png->height_px,
                        [counts_of = png->counts, a, b]() -> Result<DepthImage> {
                          const Result<RawDepthImage> counts = counts_of();
                          if (!counts) return counts.error();
                          return unquantised(*counts, a, b);
                        });
}

Result<DepthPicture> depth_of_compressed(const StoredMessage& message) {
  const auto image = read_compressed_image(*message.bytes, message.wire);
  if (!image || image->data.size() < kDepthHead) return damaged(message);
  if (!is_compressed_depth(image->format)) {
    return message_error(message, fmt::format("is {}; depth is {}: name its topic with "
                                              "--topic-depth",
                                              quote(image->format), kDepthIs));
  }
  return unpacked_depth(message.name, *image);
}

Result<void> check_lens(const CameraInfoMessage& info) {
  const std::string& model = info.distortion_model;
  const bool ours = model.empty() || model == "plumb_bob" || model == "rational_polynomial" ||
                    model == "none" || model == "brown_conrady";
  const bool none = std::all_of(info.d.begin(), info.d.end(), [](double v) { return v == 0; });
  const bool more = info.d.size() > 5 &&
                    std::any_of(info.d.begin() + 5, info.d.end(), [](double v) { return v != 0; });
  if (none || (ours && !more)) return {};
  return Error{
      fmt::format("is of a lens {}{}; only pinhole with k1, k2, p1, p2, k3 is computed with: take "
                  "the rectified "
                  "pictures, or name a camera file",
                  quote(model), more ? " with more than five coefficients" : "")};
}

}  // namespace

PictureNature nature_of(const StoredMessage& message) {
  if (message.kind == MessageKind::compressed_image) {
    const auto image = read_compressed_image(*message.bytes, message.wire);
    if (!image) return {};
    const bool depth = is_compressed_depth(image->format);
    const bool counts = image->format.starts_with("16UC1") || image->format.starts_with("mono16");
    const PictureUse use = depth                                ? PictureUse::depth
                           : counts                             ? PictureUse::neither
                           : image->format.starts_with("mono8") ? PictureUse::grey
                                                                : PictureUse::colour;
    return {use, on_one_line(image->format)};
  }
  const auto image = read_image(*message.bytes, message.wire);
  if (!image) return {};
  const ColourEncoding* const colour = colour_encoding(image->encoding);
  const PictureUse use = colour ? (colour->size == 1 ? PictureUse::grey : PictureUse::colour)
                         : is_counts(image->encoding) || is_metres(image->encoding)
                             ? PictureUse::depth
                             : PictureUse::neither;
  return {use, on_one_line(image->encoding)};
}

Result<ColourPicture> colour_of(const StoredMessage& message) {
  if (message.kind == MessageKind::compressed_image) {
    const auto image = read_compressed_image(*message.bytes, message.wire);
    if (!image) return damaged(message);
    return colour_picture(message.name, std::string(image->data));
  }
  const auto image = read_image(*message.bytes, message.wire);
  if (!image) return damaged(message);
  const ColourEncoding* const encoding = colour_encoding(image->encoding);
  if (encoding == nullptr) {
    return message_error(message, fmt::format("is {}; colour is {}: name its topic with "
                                              "--topic-colour",
                                              quote(image->encoding), kColoursAre));
  }
  if (auto r = check_rows(message, *image, encoding->size); !r) return r.error();
  return ColourPicture{message.name, static_cast<int>(image->width_px),
                       static_cast<int>(image->height_px),
                       [bytes = message.bytes, wire = message.wire, encoding] {
                         return Result(decode_rows(read_image(*bytes, wire).value(), *encoding));
                       }};
}

Result<ColourImage> colour_of(const ImageMessage& image) {
  const ColourEncoding* const encoding = colour_encoding(image.encoding);
  if (!encoding) {
    return Error{
        fmt::format("colour images in {} are not read; rgb8, bgr8, rgba8, bgra8 and mono8 are",
                    quote(image.encoding))};
  }
  if (!has_rows(image, encoding->size)) return damaged(image);
  return decode_rows(image, *encoding);
}

Result<DepthImage> depth_of(const ImageMessage& image, const Camera& camera) {
  const bool counts = is_counts(image.encoding);
  if (!counts && !is_metres(image.encoding)) {
    return Error{
        fmt::format("depth images in {} are not read; 16UC1 (millimetres) and 32FC1 (metres) are",
                    quote(image.encoding))};
  }
  if (!has_rows(image, counts ? 2 : 4)) return damaged(image);
  if (!counts) return within_limits(numbers_of<float>(image), camera);
  Camera in_mm = camera;
  in_mm.depth_scale = 1000;
  return to_metres(numbers_of<std::uint16_t>(image), in_mm);
}

Result<ColourImage> colour_of(const CompressedImageMessage& image) {
  if (is_compressed_depth(image.format)) {
    return Error{
        fmt::format("colour images in {} are not read; JPEG and PNG are", quote(image.format))};
  }
  const Result<ColourPicture> picture = colour_picture("colour", std::string(image.data));
  if (!picture) return picture.error();
  return picture->decode();
}

Result<DepthImage> depth_of(const CompressedImageMessage& image, const Camera& camera) {
  if (!is_compressed_depth(image.format) || image.data.size() < kDepthHead) {
    return Error{fmt::format("depth images in {} are not read; compressedDepth as PNG is",
                             quote(image.format))};
  }
  const Result<DepthPicture> picture = unpacked_depth("depth", image);
  if (!picture) return picture.error();
  Camera in_mm = camera;
  in_mm.depth_scale = 1000;
  return picture->metres(in_mm);
}

Result<DepthPicture> depth_of(const StoredMessage& message) {
  return message.kind == MessageKind::compressed_image ? depth_of_compressed(message)
                                                       : depth_of_image(message);
}

Result<Camera> camera_of(const CameraInfoMessage& info, bool rectified) {
  Camera camera{.name = "camera_info"};
  camera.width_px = static_cast<int>(std::min(info.width_px, kLargestSide_px + 1));
  camera.height_px = static_cast<int>(std::min(info.height_px, kLargestSide_px + 1));
  camera.depth_scale = 1000;
  const bool by_p = rectified && info.p[0] > 0;
  if (!by_p && !(info.k[0] > 0)) {
    return Error{"says that the camera was never calibrated (K is 0); name a camera file"};
  }
  if (by_p) {
    camera.fx_px = info.p[0], camera.cx_px = info.p[2];
    camera.fy_px = info.p[5], camera.cy_px = info.p[6];
  } else {
    if (auto r = check_lens(info); !r) return r.error();
    camera.fx_px = info.k[0], camera.cx_px = info.k[2];
    camera.fy_px = info.k[4], camera.cy_px = info.k[5];
    std::vector<double> d = info.d;
    d.resize(5);
    camera.k1 = d[0], camera.k2 = d[1], camera.p1 = d[2], camera.p2 = d[3], camera.k3 = d[4];
  }
  if (auto r = check_camera(camera); !r) return r.error();
  return camera;
}

}  // namespace ydd
