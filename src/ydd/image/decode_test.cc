// SPDX-License-Identifier: Apache-2.0
#include "ydd/image/decode.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "ydd/base/files.h"
#include "ydd/image/image_header.h"

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
  /// A JPEG of the colour pattern's size, smooth so that compression hardly changes it.
  std::string jpeg(int cv_type = CV_8UC3, const std::vector<int>& parameters = {}) const {
    cv::Mat image(kHeight, kWidth, cv_type);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth * image.channels(); ++x) {
        image.ptr(y)[x] = static_cast<uchar>(40 + 2 * y + x / 3);
      }
    }
    std::vector<uchar> bytes;
    cv::imencode(".jpg", image, bytes, parameters);
    return {bytes.begin(), bytes.end()};
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
  const std::vector<int> progressive = {cv::IMWRITE_JPEG_PROGRESSIVE, 1};
  for (const std::string& bytes : {jpeg(), jpeg(CV_8UC1), jpeg(CV_8UC3, progressive)}) {
    const auto image = load_colour(put("image", bytes));
    ASSERT_TRUE(image) << image.error().message;
    ASSERT_EQ(image->width(), kWidth);
    ASSERT_EQ(image->height(), kHeight);
    EXPECT_NEAR((*image)(0, 20)[1], 80, 4);
  }
}

TEST_F(DecodeTest, TruncationIsFoundWhereverItIs) {
  ASSERT_TRUE(write_png(folder_ / "c.png", colour_pattern()));
  const std::string png = *read_file(folder_ / "c.png");
  const std::vector<std::string> files = {png, jpeg(),
                                          jpeg(CV_8UC3, {cv::IMWRITE_JPEG_PROGRESSIVE, 1})};
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

TEST_F(DecodeTest, WhatIsNoImage) {
  EXPECT_THAT(colour_error(""), EndsWith("image: is an empty file"));
  EXPECT_THAT(colour_error("GIF89a"), EndsWith("image: is neither PNG nor JPEG"));
  EXPECT_THAT(load_colour(folder_ / "none.png").error().message,
              EndsWith("none.png: cannot be opened for reading"));
  EXPECT_THAT(load_colour(folder_).error().message, HasSubstr("cannot be opened"));
}

TEST_F(DecodeTest, BrokenSizesAreRefusedBeforeAnythingIsAllocated) {
  ASSERT_TRUE(write_png(folder_ / "c.png", colour_pattern()));
  std::string png = *read_file(folder_ / "c.png");
  png.replace(16, 4, std::string("\x7f\xff\xff\xff", 4));
  EXPECT_THAT(colour_error(png), HasSubstr("has a broken header (size 2147483647x47)"));
  png.replace(16, 4, std::string(4, '\0'));
  EXPECT_THAT(colour_error(png), HasSubstr("has a broken header (size 0x47)"));
}

TEST_F(DecodeTest, DepthMustBeOneChannelOf16Bits) {
  ASSERT_TRUE(write_png(folder_ / "g.png", to_grey(colour_pattern())));
  EXPECT_THAT(load_raw_depth(folder_ / "g.png").error().message,
              HasSubstr("g.png: has 1 channels of 8 bits where a depth image"));
  EXPECT_THAT(load_raw_depth(put("j.jpg", jpeg())).error().message,
              HasSubstr("j.jpg: has 3 channels of 8 bits"));
  ASSERT_TRUE(write_png(folder_ / "d.png", depth_pattern()));
  EXPECT_THAT(load_colour(folder_ / "d.png").error().message,
              HasSubstr("d.png: has 16 bits a channel where a colour image with 8 is needed"));
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
              HasSubstr("e.png: cannot be encoded"));
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
