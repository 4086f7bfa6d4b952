// SPDX-License-Identifier: Apache-2.0
// What others write: PNG of every kind, headers that lie, files that are no picture for us.
#include <sys/resource.h>

#include <array>
#include <cstdio>  // jpeglib.h needs it
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <jpeglib.h>

#include "ydd/image/decode.h"
#include "ydd/image/png_testing.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing_png::Head;

class ImageKindsTest : public testing::Test {
 protected:
  ImageKindsTest()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("image_kinds_") +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ImageKindsTest() override { fs::remove_all(folder_); }

  fs::path put(const std::string& bytes) const {
    std::ofstream(folder_ / "image", std::ios::binary) << bytes;
    return folder_ / "image";
  }
  std::string colour_error(const std::string& bytes) const {
    const auto image = load_colour(put(bytes));
    return image ? "no error" : image.error().message;
  }
  std::string depth_error(const std::string& bytes) const {
    const auto image = load_depth(put(bytes), Camera());
    return image ? "no error" : image.error().message;
  }

  fs::path folder_;
};

/// Differs between neighbours in every direction and between channels.
unsigned sample(int x, int y, int c, int bits) {
  const auto mixed = static_cast<unsigned>(x * 40503 + y * 30011 + c * 21017);
  return (mixed >> 2U) & ((1U << static_cast<unsigned>(bits)) - 1);
}

std::string palette(int n_colours) {
  std::string bytes;
  for (int i = 0; i < n_colours; ++i) {
    bytes += {static_cast<char>(i), static_cast<char>(255 - i), static_cast<char>(7 * i)};
  }
  return testing_png::chunk("PLTE", bytes);
}

std::string picture_of(const Head& head, const std::string& more) {
  const auto samples = [&](int x, int y, int c) { return sample(x, y, c, head.bits); };
  return testing_png::file(head, testing_png::rows_of(head, samples), more);
}

Bgr expected_colour(const Head& head, int x, int y) {
  const auto at = [&](int c) {
    const unsigned value = sample(x, y, c, head.bits);
    if (head.bits == 16) return static_cast<std::uint8_t>(value >> 8U);
    return static_cast<std::uint8_t>(value * 255 / ((1U << static_cast<unsigned>(head.bits)) - 1));
  };
  if (head.colour_type == 3) {
    const unsigned i = sample(x, y, 0, head.bits);
    return {static_cast<std::uint8_t>(7 * i), static_cast<std::uint8_t>(255 - i),
            static_cast<std::uint8_t>(i)};
  }
  const bool is_grey = head.colour_type == 0 || head.colour_type == 4;
  return is_grey ? Bgr{at(0), at(0), at(0)} : Bgr{at(2), at(1), at(0)};
}

TEST_F(ImageKindsTest, PngOfEveryKindIsRead) {
  const std::vector<std::array<int, 2>> kinds = {// colour type, bits
                                                 {0, 1}, {0, 2},  {0, 4},  {0, 8}, {0, 16},
                                                 {2, 8}, {2, 16}, {3, 1},  {3, 2}, {3, 4},
                                                 {3, 8}, {4, 8},  {4, 16}, {6, 8}, {6, 16}};
  // Sizes with empty passes, one pixel, rows that end within a byte.
  const std::vector<std::array<std::uint32_t, 2>> sizes = {
      {61, 47}, {1, 1}, {3, 2}, {5, 1}, {8, 8}};
  for (const auto& [colour_type, bits] : kinds) {
    for (const auto& [width, height] : sizes) {
      for (const int interlacing : {0, 1}) {
        const Head head{width, height, bits, colour_type, interlacing};
        SCOPED_TRACE(testing::Message()
                     << "colour type " << colour_type << ", " << bits << " bits, " << width << "x"
                     << height << ", " << interlacing);
        std::string more = testing_png::chunk("gAMA", testing_png::big_endian(100000));
        if (colour_type == 3) more += palette(1 << bits);
        if (colour_type == 3) more += testing_png::chunk("tRNS", std::string(2, '\0'));
        const auto image = load_colour(put(picture_of(head, more)));
        ASSERT_TRUE(image) << image.error().message;
        ASSERT_EQ(image->width(), static_cast<int>(width));
        ASSERT_EQ(image->height(), static_cast<int>(height));
        for (int y = 0; y < image->height(); ++y) {
          for (int x = 0; x < image->width(); ++x) {
            ASSERT_EQ((*image)(x, y), expected_colour(head, x, y)) << x << " " << y;
          }
        }
      }
    }
  }
}

TEST_F(ImageKindsTest, InterlacedDepthIsRead) {
  for (const int interlacing : {0, 1}) {
    const Head head{61, 47, 16, 0, interlacing};
    const auto counts = load_raw_depth(put(picture_of(head, "")));
    ASSERT_TRUE(counts) << counts.error().message;
    for (int y = 0; y < 47; ++y) {
      for (int x = 0; x < 61; ++x) ASSERT_EQ((*counts)(x, y), sample(x, y, 0, 16));
    }
    EXPECT_EQ(depth_error(picture_of(head, "")), "no error");
  }
}

TEST_F(ImageKindsTest, PaletteThatLacksColours) {
  const Head head{61, 47, 8, 3};
  EXPECT_EQ(colour_error(picture_of(head, palette(256))), "no error");
  const std::string reason = "image: has a pixel whose colour is not in its palette; copy it again";
  EXPECT_THAT(colour_error(picture_of(head, palette(255))), EndsWith(reason));
  EXPECT_THAT(colour_error(picture_of(head, "")), EndsWith(reason));
}

TEST_F(ImageKindsTest, KindsThatPngDoesNotHave) {
  const std::vector<std::array<int, 3>> kinds = {{1, 8, 0}, {2, 4, 0}, {3, 16, 0}, {6, 1, 0},
                                                 {0, 3, 0}, {7, 8, 0}, {2, 8, 2}};
  for (const auto& [colour_type, bits, interlacing] : kinds) {
    const Head head{8, 8, bits, colour_type, interlacing};
    EXPECT_THAT(colour_error(testing_png::file(head, std::string(500, '\0'))),
                HasSubstr("image: has a broken PNG header (colour type"))
        << colour_type << " " << bits;
  }
}

enum class JpegScans { one, one_per_channel };

/// A flat grey picture, in three channels.
std::string jpeg_in(JpegScans scans = JpegScans::one) {
  constexpr int kSide = 64;
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* data = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): libjpeg's type
  jpeg_mem_dest(&info, &data, &size);
  info.image_width = kSide;
  info.image_height = kSide;
  info.input_components = 3;
  info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&info);
  const std::array<jpeg_scan_info, 3> separate = {
      {{1, {0}, 0, 63, 0, 0}, {1, {1}, 0, 63, 0, 0}, {1, {2}, 0, 63, 0, 0}}};
  if (scans == JpegScans::one_per_channel) {
    info.scan_info = separate.data();
    info.num_scans = 3;
  }
  jpeg_start_compress(&info, TRUE);
  std::vector<std::uint8_t> row(std::size_t{3} * kSide, 90);
  JSAMPROW pointer = row.data();
  for (int y = 0; y < kSide; ++y) jpeg_write_scanlines(&info, &pointer, 1);
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  std::string bytes(reinterpret_cast<const char*>(data), size);
  std::free(data);
  return bytes;
}

/// The same file with another size in its frame header.
std::string jpeg_of_size(std::string bytes, int width, int height) {
  const std::size_t at = bytes.find("\xff\xc0");
  for (const auto& [offset, value] : {std::pair(5, height), std::pair(7, width)}) {
    bytes[at + offset] = static_cast<char>(value >> 8);
    bytes[at + offset + 1] = static_cast<char>(value);
  }
  return bytes;
}

/// Most memory this process ever had, in MB.
long peak_mb() {  // NOLINT(google-runtime-int): getrusage's type
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

TEST_F(ImageKindsTest, ASizeThatTheFileCannotHoldCostsNoMemory) {
  const auto before_mb = peak_mb();
  const std::string small = jpeg_in();
  EXPECT_EQ(colour_error(small), "no error");
  EXPECT_THAT(colour_error(jpeg_of_size(small, 16384, 16384)),
              HasSubstr("image: has a broken header (size 16384x16384; at most 16384 pixels a side "
                        "and 67 million in all are read)"));
  EXPECT_THAT(colour_error(jpeg_of_size(small, 8192, 8192)),
              AllOf(HasSubstr("image: has a broken header (size 8192x8192, which "),
                    HasSubstr(" bytes cannot hold: at most 1024 pixels a byte)")));
  const std::string rows(64, '\0');
  EXPECT_THAT(colour_error(testing_png::file({16384, 16384, 8, 2}, rows)),
              HasSubstr("image: has a broken header (size 16384x16384; at most"));
  EXPECT_THAT(colour_error(testing_png::file({8192, 8192, 8, 2}, rows)),
              HasSubstr("bytes cannot hold: at most 344 pixels a byte)"));
  EXPECT_THAT(depth_error(testing_png::file({8192, 8192, 16, 0, 1}, rows)),
              HasSubstr("bytes cannot hold: at most 516 pixels a byte)"));
  EXPECT_LT(peak_mb() - before_mb, 30);
}

TEST_F(ImageKindsTest, BlackPicturesAreNoLies) {
  // Nothing compresses better: a lens cap, a depth camera that sees nothing.
  for (const auto& [bits, colour_type] : {std::pair(8, 2), {16, 0}, {8, 0}, {1, 0}}) {
    const Head head{4096, 2048, bits, colour_type};
    const auto black = [](int, int, int) { return 0U; };
    EXPECT_EQ(colour_error(testing_png::file(head, testing_png::rows_of(head, black))), "no error")
        << bits << " bits, colour type " << colour_type;
  }
  ASSERT_TRUE(write_jpeg(folder_ / "black.jpg",
                         ColourImage(4096, 2048, std::vector<Bgr>(std::size_t{4096} * 2048)), 1));
  EXPECT_TRUE(load_colour(folder_ / "black.jpg"));
}

TEST_F(ImageKindsTest, JpegWithScansWithoutEndIsDamaged) {
  const std::string bytes = jpeg_in(JpegScans::one_per_channel);
  EXPECT_EQ(colour_error(bytes), "no error");
  const std::size_t first = bytes.find("\xff\xda");
  const std::string scan = bytes.substr(first, bytes.find("\xff\xda", first + 2) - first);
  std::string many = bytes.substr(0, first);
  for (int i = 0; i < 200; ++i) many += scan;
  EXPECT_THAT(colour_error(many + bytes.substr(first)),
              EndsWith("image: is damaged; copy or download it again"));
}

TEST_F(ImageKindsTest, WhatIsNoDepthImageIsNamed) {
  const std::string wanted =
      "; a depth image is a PNG with one grey channel of 16 bits, which counts by the camera's "
      "depth "
      "scale";
  const auto is = [&](const std::string& kind) { return EndsWith("/image: is " + kind + wanted); };
  const auto png = [](int bits, int colour_type, int interlacing = 0) {
    return picture_of({61, 47, bits, colour_type, interlacing}, palette(2));
  };
  EXPECT_THAT(depth_error(png(8, 0)), is("a grey PNG of 8 bits a channel"));
  EXPECT_THAT(depth_error(png(1, 0)), is("a grey PNG of 1 bit a channel"));
  EXPECT_THAT(depth_error(png(1, 3)), is("a palette PNG of 1 bit a channel"));
  EXPECT_THAT(depth_error(png(16, 2)), is("a colour PNG of 16 bits a channel"));
  EXPECT_THAT(depth_error(png(16, 4)), is("a grey PNG of 16 bits a channel, with alpha"));
  EXPECT_THAT(depth_error(png(8, 6, 1)),
              is("an interlaced colour PNG of 8 bits a channel, with alpha"));
  EXPECT_THAT(depth_error(jpeg_in()), is("a colour JPEG of 8 bits a channel"));
  EXPECT_THAT(depth_error("\x76\x2f\x31\x01..."), is("an OpenEXR image"));
  EXPECT_THAT(depth_error("Pf\n640 480\n-1\n"), is("a PFM image of floats"));
  EXPECT_THAT(depth_error(std::string("II*\0", 4)), is("a TIFF image"));
  EXPECT_THAT(depth_error("\x93NUMPY"), is("a NumPy array"));
  EXPECT_THAT(depth_error("what"), is("neither PNG nor JPEG"));
  EXPECT_THAT(depth_error(""), EndsWith("/image: is an empty file"));
}

TEST_F(ImageKindsTest, WhatIsNoColourImageIsNamed) {
  EXPECT_THAT(colour_error("RIFF....WEBPVP8 "),
              EndsWith("/image: is a WebP image, neither PNG nor JPEG"));
  EXPECT_THAT(colour_error("version https://git-lfs.github.com/spec/v1\n"),
              AllOf(HasSubstr("/image: is a Git LFS pointer"), Not(HasSubstr("\n"))));
  std::string twelve_bits = jpeg_in();
  twelve_bits[twelve_bits.find("\xff\xc0") + 4] = 12;
  EXPECT_THAT(
      colour_error(twelve_bits),
      EndsWith("/image: is a colour JPEG of 12 bits a channel; of JPEG only 8 bits a channel "
               "are read"));
}

}  // namespace
}  // namespace ydd
