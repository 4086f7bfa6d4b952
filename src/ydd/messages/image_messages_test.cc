// SPDX-License-Identifier: Apache-2.0
#include "ydd/messages/ros_pictures.h"

#include <bit>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::HasSubstr;

/// Two by two pixels and two bytes of padding after each row.
std::vector<std::uint8_t> padded(const std::vector<std::uint8_t>& row0,
                                 const std::vector<std::uint8_t>& row1) {
  std::vector<std::uint8_t> out = row0;
  out.insert(out.end(), {255, 255});
  out.insert(out.end(), row1.begin(), row1.end());
  out.insert(out.end(), {255, 255});
  return out;
}

ImageMessage message(std::uint32_t width_px, std::uint32_t height_px, std::size_t step,
                     std::string_view encoding, const std::vector<std::uint8_t>& bytes) {
  ImageMessage out;
  out.width_px = width_px;
  out.height_px = height_px;
  out.step = static_cast<std::uint32_t>(step);
  out.encoding = encoding;
  out.data = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  return out;
}

ImageMessage image(std::string_view encoding, const std::vector<std::uint8_t>& bytes) {
  return message(2, 2, bytes.size() / 2, encoding, bytes);
}

TEST(ImageMessages, ColourComesAsBgrWhateverTheOrder) {
  const auto bgr = padded({1, 2, 3, 4, 5, 6}, {7, 8, 9, 10, 11, 12});
  const auto rgb = padded({3, 2, 1, 6, 5, 4}, {9, 8, 7, 12, 11, 10});
  const auto rgba = padded({3, 2, 1, 99, 6, 5, 4, 99}, {9, 8, 7, 99, 12, 11, 10, 99});
  const auto bgra = padded({1, 2, 3, 99, 4, 5, 6, 99}, {7, 8, 9, 99, 10, 11, 12, 99});
  for (const ImageMessage& seen : {image("bgr8", bgr), image("rgb8", rgb), image("rgba8", rgba),
                                   image("bgra8", bgra), image("8UC3", bgr)}) {
    const auto colour = colour_of(seen);
    ASSERT_TRUE(colour) << colour.error().message;
    EXPECT_EQ((*colour)(0, 0), (Bgr{1, 2, 3})) << seen.encoding;
    EXPECT_EQ((*colour)(1, 0), (Bgr{4, 5, 6})) << seen.encoding;
    EXPECT_EQ((*colour)(1, 1), (Bgr{10, 11, 12})) << seen.encoding;
  }
  const auto grey = padded({1, 2}, {3, 4});
  EXPECT_EQ((*colour_of(image("mono8", grey)))(1, 1), (Bgr{4, 4, 4}));
}

TEST(ImageMessages, DepthIsMetres) {
  const Camera camera;                                                         // 0.1 to 10 m
  const auto mm = padded({0x00, 0x00, 0xE8, 0x03}, {0x32, 0x00, 0x10, 0x27});  // 0 1000 50 10000
  const auto depth = depth_of(image("16UC1", mm), camera);
  ASSERT_TRUE(depth) << depth.error().message;
  EXPECT_EQ((*depth)(0, 0), 0);
  EXPECT_FLOAT_EQ((*depth)(1, 0), 1);
  EXPECT_EQ((*depth)(0, 1), 0) << "nearer than the camera reads";
  EXPECT_FLOAT_EQ((*depth)(1, 1), 10);
  ImageMessage turned = image("16UC1", mm);
  turned.big_endian = true;
  EXPECT_FLOAT_EQ((*depth_of(turned, camera))(0, 1), 0) << "0x3200 mm is too far";
  std::vector<std::uint8_t> bytes(16);
  const std::array<float, 4> metres = {1.5F, std::numeric_limits<float>::quiet_NaN(), -1,
                                       std::numeric_limits<float>::infinity()};
  std::memcpy(bytes.data(), metres.data(), 16);
  const auto floats = depth_of(message(2, 2, 8, "32FC1", bytes), camera);
  ASSERT_TRUE(floats) << floats.error().message;
  EXPECT_FLOAT_EQ((*floats)(0, 0), 1.5F);
  for (const auto& [x, y] : {std::pair{1, 0}, {0, 1}, {1, 1}}) EXPECT_EQ((*floats)(x, y), 0);
}

TEST(ImageMessages, WhatIsDamagedOrUnknownIsOneLine) {
  const std::vector<std::uint8_t> bytes(12);
  EXPECT_THAT(colour_of(message(2, 2, 6, "bayer_rggb8", bytes)).error().message,
              HasSubstr("'bayer_rggb8' are not read"));
  EXPECT_THAT(depth_of(message(2, 2, 6, "rgb8", bytes), {}).error().message,
              HasSubstr("16UC1 (millimetres)"));
  constexpr std::uint32_t kNegative = 0xFFFFFFFFU;
  for (const ImageMessage& wrong :
       {message(2, 3, 6, "bgr8", bytes), message(3, 2, 6, "bgr8", bytes),
        message(0, 2, 6, "bgr8", bytes), message(2, 2, 0, "bgr8", bytes),
        message(kNegative, 2, 6, "bgr8", bytes), message(2, 2, 6, "bgr8", {}),
        message(1U << 30U, 1U << 30U, std::size_t{3} << 30U, "bgr8", bytes)}) {
    ASSERT_FALSE(colour_of(wrong));
    EXPECT_THAT(colour_of(wrong).error().message, HasSubstr("damaged"));
  }
}

CameraInfoMessage calibrated() {
  CameraInfoMessage info;
  info.width_px = 640;
  info.height_px = 480;
  info.k = {525, 0, 319.5, 0, 525, 239.5, 0, 0, 1};
  info.d = {0.1, -0.2, 0, 0, 0.05};
  info.distortion_model = "plumb_bob";
  return info;
}

TEST(ImageMessages, CalibrationIsACamera) {
  const auto camera = camera_of(calibrated(), false);
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->fx_px, 525);
  EXPECT_EQ(camera->cy_px, 239.5);
  EXPECT_EQ(camera->k2, -0.2);
  EXPECT_EQ(camera->k3, 0.05);
  EXPECT_EQ(camera->depth_scale, 1000);
  CameraInfoMessage straight = calibrated();
  straight.d.assign(8, 0);
  straight.distortion_model = "rational_polynomial";
  EXPECT_TRUE(camera_of(straight, false)) << "no distortion is none in any model";
}

TEST(ImageMessages, CalibrationsOfNoCameraAreRefused) {
  CameraInfoMessage empty = calibrated();
  empty.k = {};
  EXPECT_THAT(camera_of(empty, false).error().message, HasSubstr("K is 0"));
  CameraInfoMessage fisheye = calibrated();
  fisheye.distortion_model = "equidistant";
  EXPECT_THAT(camera_of(fisheye, false).error().message, HasSubstr("'equidistant'"));
  CameraInfoMessage wild = calibrated();
  wild.k[2] = 5000;
  EXPECT_FALSE(camera_of(wild, false)) << "the centre is far outside of the picture";
  CameraInfoMessage nan = calibrated();
  nan.k[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(camera_of(nan, false));
}

}  // namespace
}  // namespace ydd
