// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/decode.h"

#include <array>
#include <cmath>
#include <cstdio>  // jpeglib.h needs it
#include <cstdlib>
#include <fstream>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <jpeglib.h>

#include "ydd/base/files.h"
#include "ydd/image/image_header.h"
#include "ydd/image/png_decoder.h"
#include "ydd/image/png_testing.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using testing::EndsWith;
using testing::HasSubstr;

constexpr int kWidth = 61;  // odd: vector loops have a rest
constexpr int kHeight = 47;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;

ColourImage colour_pattern() {
  std::vector<Bgr> pixels(kPixels);
  for (std::size_t i = 0; i < kPixels; ++i) {
    pixels[i] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(3 * i + 7),
                 static_cast<std::uint8_t>(i / 11)};
  }
  return {kWidth, kHeight, std::move(pixels)};
}

RawDepthImage depth_pattern() {
  std::vector<std::uint16_t> counts(kPixels);
  for (std::size_t i = 0; i < kPixels; ++i) counts[i] = static_cast<std::uint16_t>(i * 23);
  return {kWidth, kHeight, std::move(counts)};
}

template <class T>
std::vector<T> pixels_of(const Image<T>& image) {
  return {image.data(), image.data() + std::size_t(image.width()) * image.height()};
}

enum class JpegKind { colour, grey, progressive };

/// Brighter to the right and down: compression hardly changes it.
std::uint8_t smooth(int x, int y) { return static_cast<std::uint8_t>(40 + 2 * y + x); }

std::string jpeg(JpegKind kind = JpegKind::colour) {
  const bool is_grey = kind == JpegKind::grey;
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &data, &size);
  info.image_width = kWidth;
  info.image_height = kHeight;
  info.input_components = is_grey ? 1 : 3;
  info.in_color_space = is_grey ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&info);
  if (kind == JpegKind::progressive) jpeg_simple_progression(&info);
  jpeg_start_compress(&info, TRUE);
  for (int y = 0; y < kHeight; ++y) {
    std::vector<std::uint8_t> row;
    for (int x = 0; x < kWidth; ++x) row.insert(row.end(), is_grey ? 1 : 3, smooth(x, y));
    JSAMPROW pointer = row.data();
    jpeg_write_scanlines(&info, &pointer, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  std::string bytes(reinterpret_cast<const char*>(data), size);
  std::free(data);
  return bytes;
}

class DecodeTest : public testing::Test {
 protected:
  DecodeTest()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("decode_") +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~DecodeTest() override { fs::remove_all(folder_); }

  fs::path put(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  std::string colour_error(const std::string& bytes) const {
    const auto image = load_colour(put("image", bytes));
    return image ? "no error" : image.error().message;
  }

  fs::path folder_;
};

TEST_F(DecodeTest, PngKeepsEveryPixel) {
  ASSERT_TRUE(write_png(folder_ / "c.png", colour_pattern()));
  EXPECT_EQ(pixels_of(*load_colour(folder_ / "c.png")), pixels_of(colour_pattern()));
  ASSERT_TRUE(write_png(folder_ / "d.png", depth_pattern()));
  EXPECT_EQ(pixels_of(*load_raw_depth(folder_ / "d.png")), pixels_of(depth_pattern()));
  const GreyImage grey = to_grey(colour_pattern());
  ASSERT_TRUE(write_png(folder_ / "g.png", grey));
  const auto back = load_colour(folder_ / "g.png");  // three equal channels
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ((*back)(17, 13), (Bgr{grey(17, 13), grey(17, 13), grey(17, 13)}));
  EXPECT_EQ(pixels_of(to_grey(*back)), pixels_of(grey));
}

TEST_F(DecodeTest, JpegOfEveryKind) {
  for (const JpegKind kind : {JpegKind::colour, JpegKind::grey, JpegKind::progressive}) {
    const auto image = load_colour(put("image", jpeg(kind)));
    ASSERT_TRUE(image) << image.error().message;
    ASSERT_EQ(image->width(), kWidth);
    ASSERT_EQ(image->height(), kHeight);
    for (const int channel : {0, 1, 2}) EXPECT_NEAR((*image)(30, 20)[channel], smooth(30, 20), 4);
  }
}

TEST_F(DecodeTest, WrittenJpegComesBackNearly) {
  std::vector<Bgr> pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) pixels.push_back({smooth(x, y), 200, smooth(0, y)});
  }
  const ColourImage image(kWidth, kHeight, std::move(pixels));
  ASSERT_TRUE(write_jpeg(folder_ / "j.jpg", image, 95));
  const auto back = load_colour(folder_ / "j.jpg");
  ASSERT_TRUE(back) << back.error().message;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR((*back)(x, y)[c], image(x, y)[c], 8);
    }
  }
  ASSERT_TRUE(write_jpeg(folder_ / "small.jpg", image, 30));
  EXPECT_LT(fs::file_size(folder_ / "small.jpg"), fs::file_size(folder_ / "j.jpg"));
  EXPECT_THROW((void)write_jpeg(folder_ / "j.jpg", image, 0), std::logic_error);
}

TEST_F(DecodeTest, TruncationIsFoundWhereverItIs) {
  ASSERT_TRUE(write_png(folder_ / "c.png", colour_pattern()));
  const std::string png = *read_file(folder_ / "c.png");
  const std::vector<std::string> files = {png, jpeg(), jpeg(JpegKind::progressive)};
  for (const std::string& bytes : files) {
    EXPECT_EQ(colour_error(bytes), "no error");
    for (std::size_t size = 1; size < bytes.size(); size += 1 + bytes.size() / 97) {
      EXPECT_THAT(colour_error(bytes.substr(0, size)), testing::StartsWith(folder_.string()))
          << size << " of " << bytes.size();
    }
    EXPECT_THAT(colour_error(bytes.substr(0, bytes.size() - 1)), HasSubstr("is truncated"));
    EXPECT_EQ(colour_error(bytes + std::string(100, '\0')), "no error");  // padding is harmless
  }
}

TEST_F(DecodeTest, DamageInTheMiddleIsFound) {
  ASSERT_TRUE(write_png(folder_ / "c.png", colour_pattern()));
  std::string png = *read_file(folder_ / "c.png");
  png[png.size() / 2] ^= 0x55;
  EXPECT_THAT(colour_error(png), EndsWith("image: is damaged; copy or download it again"));
}

TEST_F(DecodeTest, DamagedJpegIsFound) {
  std::string bytes = jpeg();
  bytes.erase(bytes.size() - 100, 50);  // the blocks end early
  EXPECT_THAT(colour_error(bytes), EndsWith("image: is damaged; copy or download it again"));
}

/// A PNG whose row y has filter y % 5, so that each is used on top of each.
std::string png_with_all_filters(const std::vector<std::uint8_t>& samples, int bits, int colour,
                                 std::size_t pixel_size, std::uint8_t last_filter = 4) {
  const auto at = [&](std::size_t y, std::ptrdiff_t x) {
    return x < 0 ? 0 : static_cast<int>(samples[y * kWidth * pixel_size + std::size_t(x)]);
  };
  std::string filtered;
  for (std::size_t y = 0; y < std::size_t{kHeight}; ++y) {
    const auto filter = static_cast<std::uint8_t>(y % (last_filter + 1U));
    filtered += static_cast<char>(filter);
    for (std::ptrdiff_t x = 0; x < std::ptrdiff_t(kWidth * pixel_size); ++x) {
      const std::ptrdiff_t before = x - std::ptrdiff_t(pixel_size);
      const int a = at(y, before);
      const int b = y == 0 ? 0 : at(y - 1, x);
      const int c = y == 0 ? 0 : at(y - 1, before);
      const int p = a + b - c;
      int best = std::abs(p - b) <= std::abs(p - c) ? b : c;
      if (std::abs(p - a) <= std::abs(p - b) && std::abs(p - a) <= std::abs(p - c)) best = a;
      const std::array<int, 6> predicted = {0, a, b, (a + b) / 2, best, 0};
      filtered += static_cast<char>(at(y, x) - predicted[filter]);
    }
  }
  return testing_png::file({kWidth, kHeight, bits, colour}, filtered);
}

struct PngKind {
  int bits, colour;
  std::size_t pixel_size;
};

TEST_F(DecodeTest, PngOfEveryFilterAndPixelSize) {
  const std::vector<PngKind> kinds = {{8, 0, 1}, {8, 4, 2},  {16, 0, 2}, {8, 2, 3},
                                      {8, 6, 4}, {16, 2, 6}, {16, 6, 8}};
  for (const auto& [bits, colour, pixel_size] : kinds) {
    std::vector<std::uint8_t> samples(kPixels * pixel_size);
    std::mt19937 random(7);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      samples[i] = static_cast<std::uint8_t>(i / 50 + random() % (i % 7 == 0 ? 256 : 20));
    }
    const std::string bytes = png_with_all_filters(samples, bits, colour, pixel_size);
    const auto header = read_image_header(bytes);
    ASSERT_TRUE(header) << header.error().message;
    const auto decoded = decode_png(bytes, *header);
    ASSERT_TRUE(decoded) << decoded.error().message;
    std::vector<std::uint8_t> joined;
    for (int y = 0; y < kHeight; ++y) {
      joined.insert(joined.end(), decoded->row(y), decoded->row(y) + decoded->row_size);
    }
    EXPECT_EQ(joined, samples) << bits << " bits, colour type " << colour;
  }
}

TEST_F(DecodeTest, PngWithWrongContentIsDamaged) {
  const std::vector<std::uint8_t> samples(kPixels * 3, 9);
  EXPECT_EQ(colour_error(png_with_all_filters(samples, 8, 2, 3)), "no error");
  EXPECT_THAT(colour_error(png_with_all_filters(samples, 8, 2, 3, 5)), HasSubstr("is damaged"));
  EXPECT_THAT(colour_error(png_with_all_filters(samples, 8, 6, 3)), HasSubstr("is damaged"));
  EXPECT_THAT(colour_error(png_with_all_filters(samples, 8, 3, 3)), HasSubstr("is damaged"));
}

TEST_F(DecodeTest, WhatIsNoImage) {
  EXPECT_THAT(colour_error(""), EndsWith("image: is an empty file"));
  EXPECT_THAT(colour_error("GIF89a"), EndsWith("image: is a GIF image, neither PNG nor JPEG"));
  EXPECT_THAT(colour_error("hello"), EndsWith("image: is neither PNG nor JPEG"));
  EXPECT_THAT(load_colour(folder_ / "none.png").error().message,
              EndsWith("none.png: cannot be opened for reading"));
  EXPECT_THAT(load_colour(folder_).error().message, HasSubstr("is a folder, not a file"));
}

TEST_F(DecodeTest, BrokenSizesAreRefusedBeforeAnythingIsAllocated) {
  ASSERT_TRUE(write_png(folder_ / "c.png", colour_pattern()));
  std::string png = *read_file(folder_ / "c.png");
  png.replace(16, 4, std::string("\x7f\xff\xff\xff", 4));
  EXPECT_THAT(colour_error(png),
              HasSubstr("has a broken header (size 2147483647x47; at most 16384"));
  png.replace(16, 4, std::string("\xff\xff\xff\xff", 4));
  EXPECT_THAT(colour_error(png), HasSubstr("has a broken header (size 4294967295x47; at most"));
  png.replace(16, 4, std::string(4, '\0'));
  EXPECT_THAT(colour_error(png), HasSubstr("has a broken header (size 0x47)"));
}

TEST_F(DecodeTest, HeaderOfGreyPng) {
  ASSERT_TRUE(write_png(folder_ / "d.png", depth_pattern()));
  const auto header = read_image_header(*read_file(folder_ / "d.png"));
  ASSERT_TRUE(header) << header.error().message;
  EXPECT_EQ(header->width_px, kWidth);
  EXPECT_EQ(header->height_px, kHeight);
  EXPECT_EQ(header->bits_per_channel, 16);
  EXPECT_EQ(header->channels, 1);
}

TEST_F(DecodeTest, WritingFailsWithTheFilesName) {
  EXPECT_THAT(write_png(folder_ / "no/such.png", colour_pattern()).error().message,
              HasSubstr("no/such.png: cannot be created"));
  EXPECT_THAT(write_png(folder_ / "e.png", GreyImage()).error().message,
              HasSubstr("e.png: an empty image has no file"));
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST(ToGrey, IsRoundedLuma) {
  const ColourImage colour = colour_pattern();
  const GreyImage grey = to_grey(colour);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto [b, g, r] = colour(x, y);
      ASSERT_NEAR(grey(x, y), 0.114 * b + 0.587 * g + 0.299 * r, 0.51) << x << " " << y;
    }
  }
  const ColourImage white(1, 1, {Bgr{255, 255, 255}});
  EXPECT_EQ(to_grey(white)(0, 0), 255);
}

TEST(ToMetres, ReadingsOutsideTheLimitsAreNone) {
  Camera camera;  // 5000 counts a metre
  camera.min_depth_m = 0.1;
  camera.max_depth_m = 4.0;
  const RawDepthImage raw(7, 1, {0, 499, 500, 7501, 20000, 20001, 65535});
  EXPECT_EQ(pixels_of(to_metres(raw, camera)),
            (std::vector<float>{0, 0, 0.1F, 7501.0F / 5000.0F, 4.0F, 0, 0}));
  camera.min_depth_m = 0.0;
  camera.max_depth_m = 100.0;
  EXPECT_EQ(pixels_of(to_metres(raw, camera)).front(), 0.0F);
  EXPECT_EQ(pixels_of(to_metres(raw, camera)).back(), 65535.0F / 5000.0F);
}

TEST_F(DecodeTest, LoadDepthIsLoadRawDepthInMetres) {
  Camera camera;
  camera.min_depth_m = 0.5;
  camera.max_depth_m = 6.0;
  ASSERT_TRUE(write_png(folder_ / "d.png", depth_pattern()));
  EXPECT_EQ(pixels_of(*load_depth(folder_ / "d.png", camera)),
            pixels_of(to_metres(depth_pattern(), camera)));
}

TEST(ToMetres, ComesBackThroughRawDepth) {
  Camera camera;
  camera.min_depth_m = 0;
  camera.max_depth_m = 100;
  const RawDepthImage raw = depth_pattern();
  EXPECT_EQ(pixels_of(to_raw_depth(to_metres(raw, camera), camera.depth_scale)), pixels_of(raw));
  const DepthImage odd(4, 1, {-1.0F, std::nanf(""), std::numeric_limits<float>::infinity(), 14.0F});
  EXPECT_EQ(pixels_of(to_raw_depth(odd, 5000.0)), std::vector<std::uint16_t>(4, 0));
}

}  // namespace
}  // namespace ydd
