// SPDX-License-Identifier: Apache-2.0
#include "ydd/cloud/keyframe_picture.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "ydd/dynamics/people_boxes.h"
#include "ydd/image/image_header.h"
#include "ydd/image/jpeg_codec.h"
#include "ydd/image/png_decoder.h"
#include "ydd/image/png_encoder.h"

namespace ydd {
namespace {

// All in pixels of the half-size picture. Boxes of detectors are off by some pixels, and the depth
// sensor smears a silhouette over a few more.
constexpr float kBoxMargin_px = 6.0F;
constexpr float kBoxMarginShare = 0.05F;  // of the longer side
constexpr int kSilhouette_px = 3;
constexpr float kBehind_m = 0.15F;   // this far behind what moves, a surface is background
constexpr float kAgreement = 0.03F;  // of the depth: readings of one surface
constexpr int kLargest_mm = 65'535;
constexpr int kJpegQuality = 85;
constexpr Bgr kNeutral = {128, 128, 128};
// A text in the depth picture: it stands for the whole, and older programs pass over it.
constexpr std::string_view kPeopleNote("people\0left out by their boxes", 29);

/// Mean of the four readings behind a pixel of the small picture; 0 unless at least three agree.
float half_depth_m(const DepthImage& depth_m, int x, int y) {
  float sum_m = 0;
  float least_m = HUGE_VALF;
  float most_m = 0;
  int readings = 0;
  for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
    const float d = depth_m(2 * x + dx, 2 * y + dy);
    if (!(d > 0.0F)) continue;
    ++readings;
    sum_m += d;
    least_m = std::min(least_m, d);
    most_m = std::max(most_m, d);
  }
  if (readings < 3 || most_m - least_m > kAgreement * least_m) return 0.0F;
  return sum_m / static_cast<float>(readings);
}

DepthImage half_size(const DepthImage& depth_m) {
  const int width = depth_m.width() / 2;
  const int height = depth_m.height() / 2;
  std::vector<float> out;
  out.reserve(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) out.push_back(half_depth_m(depth_m, x, y));
  }
  return {width, height, std::move(out)};
}

Bgr half_colour(const ColourImage& colour, int x, int y) {
  Bgr out{};
  for (std::size_t c = 0; c < 3; ++c) {
    const int sum = colour(2 * x, 2 * y)[c] + colour(2 * x + 1, 2 * y)[c] +
                    colour(2 * x, 2 * y + 1)[c] + colour(2 * x + 1, 2 * y + 1)[c];
    out[c] = static_cast<std::uint8_t>((sum + 2) / 4);
  }
  return out;
}

void mark_region(const DepthImage& half_m, const MovingRegion& region, std::vector<bool>& mask) {
  const float longer_px = std::max(region.box.x1 - region.box.x0, region.box.y1 - region.box.y0);
  const float margin_px = kBoxMargin_px + kBoxMarginShare * 0.5F * longer_px;
  const auto bound = [](float px, int size) {
    return std::clamp(static_cast<int>(std::floor(px)), 0, size);
  };
  const int x0 = bound(0.5F * region.box.x0 - margin_px, half_m.width());
  const int x1 = bound(0.5F * region.box.x1 + margin_px + 1.0F, half_m.width());
  const int y0 = bound(0.5F * region.box.y0 - margin_px, half_m.height());
  const int y1 = bound(0.5F * region.box.y1 + margin_px + 1.0F, half_m.height());
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      if (!region.mask.empty()) {
        if (!region.on_mask(2.0F * static_cast<float>(x), 2.0F * static_cast<float>(y))) continue;
        mask[static_cast<std::size_t>(y) * half_m.width() + x] = true;
        continue;
      }
      // Without a reading it has no depth to keep, whatever it is.
      const bool behind = region.range && half_m(x, y) > region.range->max_m + kBehind_m;
      if (!behind) mask[static_cast<std::size_t>(y) * half_m.width() + x] = true;
    }
  }
}

/// A region for each cell that is judged to move.
std::vector<MovingRegion> moving_cells(const MotionOdds& odds) {
  constexpr float kThickness_m = 0.1F;
  std::vector<MovingRegion> regions;
  const CellGrid& grid = odds.depth.grid;
  const auto side_px = static_cast<float>(grid.cell_px);
  for (std::size_t i = 0; i < odds.moves.size(); ++i) {
    if (odds.moves[i] == 0) continue;
    const Eigen::Vector2f at_px = grid.corner_px(i);
    const float z_m = odds.depth.z_m[i];
    regions.push_back({.rule = Rule::seen_moving,
                       .box = {at_px.x(), at_px.y(), at_px.x() + side_px, at_px.y() + side_px},
                       .range = DepthRange{z_m - kThickness_m, z_m + kThickness_m}});
  }
  return regions;
}

/// Grows what is marked along one axis: `stride` to the next pixel of a line, `step` to the next
/// line.
void grow_lines(std::vector<bool>& mask, int lines, int length, std::size_t step,
                std::size_t stride) {
  for (int line = 0; line < lines; ++line) {
    const std::size_t start = static_cast<std::size_t>(line) * step;
    std::vector<bool> grown(static_cast<std::size_t>(length));
    for (int i = 0; i < length; ++i) {
      if (!mask[start + static_cast<std::size_t>(i) * stride]) continue;
      const int last = std::min(length - 1, i + kSilhouette_px);
      for (int k = std::max(0, i - kSilhouette_px); k <= last; ++k) {
        grown[static_cast<std::size_t>(k)] = true;
      }
    }
    for (int i = 0; i < length; ++i) {
      mask[start + static_cast<std::size_t>(i) * stride] = grown[static_cast<std::size_t>(i)];
    }
  }
}

std::string encode_depth(const RawDepthImage& depth_mm, std::string_view note) {
  PngRows rows;
  rows.row_size = static_cast<std::size_t>(depth_mm.width()) * 2U;
  for (int y = 0; y < depth_mm.height(); ++y) {
    rows.bytes.push_back(0);  // the filter's
    for (int x = 0; x < depth_mm.width(); ++x) {
      rows.bytes.push_back(static_cast<std::uint8_t>(depth_mm(x, y) >> 8U));
      rows.bytes.push_back(static_cast<std::uint8_t>(depth_mm(x, y)));
    }
  }
  ImageHeader header;
  header.width_px = depth_mm.width();
  header.height_px = depth_mm.height();
  header.bits_per_channel = 16;
  header.channels = 1;
  return encode_png(rows, header, note);
}

}  // namespace

std::vector<bool> moving_mask(const DepthImage& half_m, std::span<const MovingRegion> moving) {
  const int width = half_m.width();
  const int height = half_m.height();
  std::vector<bool> mask(static_cast<std::size_t>(width) * height);
  for (const MovingRegion& region : moving) mark_region(half_m, region, mask);
  if (moving.empty()) return mask;
  grow_lines(mask, height, width, static_cast<std::size_t>(width), 1);
  grow_lines(mask, width, height, 1, static_cast<std::size_t>(width));
  return mask;
}

KeyFramePicture make_keyframe_picture(const PictureSource& source) {
  const DepthImage half_m = half_size(source.depth_m);
  std::vector<MovingRegion> regions =
      source.odds ? moving_cells(*source.odds) : std::vector<MovingRegion>();
  regions.insert(regions.end(), source.moving.begin(), source.moving.end());
  for (const Box& box : source.people) regions.push_back({-1, Rule::box, box, std::nullopt});
  const std::vector<bool> moving = moving_mask(half_m, regions);
  std::vector<std::uint16_t> depth_mm(moving.size());
  std::vector<Bgr> colour(moving.size(), kNeutral);
  for (int y = 0; y < half_m.height(); ++y) {
    for (int x = 0; x < half_m.width(); ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * half_m.width() + x;
      const auto mm = std::lround(half_m(x, y) * 1000.0F);
      if (moving[i] || mm <= 0 || mm > kLargest_mm) continue;
      depth_mm[i] = static_cast<std::uint16_t>(mm);
      colour[i] = half_colour(source.colour, x, y);
    }
  }
  KeyFramePicture picture;
  picture.width_px = half_m.width();
  picture.height_px = half_m.height();
  if (half_m.empty()) return picture;
  picture.depth_png =
      encode_depth(RawDepthImage(half_m.width(), half_m.height(), std::move(depth_mm)),
                   source.looked ? kPeopleNote : std::string_view());
  Result<std::string> jpeg =
      encode_jpeg(ColourImage(half_m.width(), half_m.height(), std::move(colour)), kJpegQuality);
  if (!jpeg) throw std::logic_error("make_keyframe_picture: " + jpeg.error().message);
  picture.colour_jpeg = std::move(*jpeg);
  return picture;
}

bool people_left_out(const KeyFramePicture& picture) {
  return png_text(picture.depth_png) == kPeopleNote;
}

Result<OpenPicture> open_keyframe_picture(const KeyFramePicture& picture) {
  const auto fits = [&](const ImageHeader& header, ImageHeader::Format format) {
    return header.format == format && header.width_px == picture.width_px &&
           header.height_px == picture.height_px;
  };
  const Result<ImageHeader> colour_header = read_image_header(picture.colour_jpeg);
  const Result<ImageHeader> depth_header = read_image_header(picture.depth_png);
  if (!colour_header || !depth_header || !fits(*colour_header, ImageHeader::Format::jpeg) ||
      !fits(*depth_header, ImageHeader::Format::png) || depth_header->bits_per_channel != 16 ||
      depth_header->channels != 1) {
    return Error{"is not what a keyframe keeps"};
  }
  Result<std::vector<Bgr>> colour = decode_jpeg(picture.colour_jpeg, *colour_header);
  if (!colour) return colour.error();
  const Result<PngRows> rows = decode_png(picture.depth_png, *depth_header);
  if (!rows) return rows.error();
  std::vector<std::uint16_t> depth_mm;
  depth_mm.reserve(colour->size());
  for (int y = 0; y < picture.height_px; ++y) {
    const std::uint8_t* const row = rows->row(y);
    for (int x = 0; x < picture.width_px; ++x) {
      depth_mm.push_back(static_cast<std::uint16_t>(row[2 * x] << 8 | row[2 * x + 1]));
    }
  }
  return OpenPicture{ColourImage(picture.width_px, picture.height_px, std::move(*colour)),
                     RawDepthImage(picture.width_px, picture.height_px, std::move(depth_mm))};
}

}  // namespace ydd
