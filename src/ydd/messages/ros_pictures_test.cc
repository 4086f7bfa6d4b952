// SPDX-License-Identifier: Apache-2.0
#include "ydd/messages/ros_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/image/encode.h"
#include "ydd/messages/wire_testing.h"

namespace ydd {
namespace {

using testing::HasSubstr;

constexpr Timestamp kStamp{12'000'000'034};

StoredMessage stored(std::string bytes, MessageKind kind, Wire wire = Wire::ros1) {
  return {"/topic, message 3", kind, wire, std::make_shared<const std::string>(std::move(bytes))};
}

/// Two pixels in a row, and one byte that belongs to no pixel.
StoredMessage two_pixels(const std::string& encoding, std::string row, Wire wire = Wire::ros1) {
  row += '?';
  const auto step = static_cast<std::uint32_t>(row.size());
  return stored(image_message(wire, kStamp, 2, 1, encoding, step, row), MessageKind::image, wire);
}

template <class T>
std::string raw(std::initializer_list<T> values, bool reversed = false) {
  std::string out;
  for (const T value : values) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    if (reversed) std::reverse(bytes.begin(), bytes.end());
    out += bytes;
  }
  return out;
}

std::string colour_error(const StoredMessage& message) {
  const auto picture = colour_of(message);
  return picture ? "no error" : picture.error().message;
}
std::string depth_error(const StoredMessage& message) {
  const auto picture = depth_of(message);
  return picture ? "no error" : picture.error().message;
}

TEST(RosPictures, EveryEncodingOfColour) {
  const std::vector<std::pair<std::string, std::string>> rows = {{"rgb8", "\3\2\1\6\5\4"},
                                                                 {"bgr8", "\1\2\3\4\5\6"},
                                                                 {"8UC3", "\1\2\3\4\5\6"},
                                                                 {"rgba8", "\3\2\1\x7f\6\5\4\x7f"},
                                                                 {"bgra8", "\1\2\3\x7f\4\5\6\x7f"}};
  for (const auto& [encoding, row] : rows) {
    for (const Wire wire : {Wire::ros1, Wire::cdr}) {
      const auto picture = colour_of(two_pixels(encoding, row, wire));
      ASSERT_TRUE(picture) << picture.error().message;
      EXPECT_EQ(picture->width_px, 2);
      const ColourImage image = picture->decode().value();
      EXPECT_EQ(image(0, 0), (Bgr{1, 2, 3})) << encoding;
      EXPECT_EQ(image(1, 0), (Bgr{4, 5, 6})) << encoding;
    }
  }
  EXPECT_EQ(colour_of(two_pixels("mono8", "\5\6"))->decode().value()(1, 0), (Bgr{6, 6, 6}));
}

TEST(RosPictures, DepthAsCountsAndMetresInEitherByteOrder) {
  Camera camera;
  camera.depth_scale = 1000;
  for (const bool big : {false, true}) {
    const std::string counts = raw<std::uint16_t>({1500, 0}, big);
    const auto message = stored(image_message(Wire::cdr, kStamp, 2, 1, "16UC1", 4, counts, big),
                                MessageKind::image, Wire::cdr);
    EXPECT_FLOAT_EQ(depth_of(message)->metres(camera).value()(0, 0), 1.5F);
    EXPECT_EQ(depth_of(message)->counts().value()(0, 0), 1500);
    const std::string metres = raw<float>({1.25F, std::nanf("")}, big);
    const auto metric = stored(image_message(Wire::ros1, kStamp, 2, 1, "32FC1", 8, metres, big),
                               MessageKind::image);
    camera.depth_scale = 5000;  // says nothing of metres
    const DepthImage depth_m = depth_of(metric)->metres(camera).value();
    EXPECT_FLOAT_EQ(depth_m(0, 0), 1.25F);
    EXPECT_EQ(depth_m(1, 0), 0.0F);
    EXPECT_EQ(depth_of(metric)->counts().value()(0, 0), 1250);
    camera.depth_scale = 1000;
  }
}

TEST(RosPictures, MetresBeyondTheCamerasLimitsAreNoReading) {
  Camera camera;
  camera.max_depth_m = 4;
  const auto metric = two_pixels("32FC1", raw<float>({5.0F, INFINITY}));
  EXPECT_EQ(depth_of(metric)->metres(camera).value()(0, 0), 0.0F);
  EXPECT_EQ(depth_of(metric)->metres(camera).value()(1, 0), 0.0F);
}

/// A PNG file of one row.
std::string png_of(std::vector<std::uint16_t> counts) {
  const TemporaryFolder folder;
  const int width = static_cast<int>(counts.size());
  EXPECT_TRUE(write_png(folder / "a.png", RawDepthImage(width, 1, std::move(counts))));
  return read_file(folder / "a.png").value();
}

TEST(RosPictures, CompressedDepth) {
  Camera camera;
  camera.depth_scale = 1000;
  const std::string head = raw<std::int32_t>({0}) + raw<float>({10100.0F, -1009.0F});
  const auto counts = stored(compressed_message(Wire::ros1, kStamp, "16UC1; compressedDepth",
                                                std::string(12, '\0') + png_of({1500, 0})),
                             MessageKind::compressed_image);
  EXPECT_FLOAT_EQ(depth_of(counts)->metres(camera).value()(0, 0), 1.5F);
  // 10100 / 2.0 - 1009 = 4041
  const auto metric = stored(
      compressed_message(Wire::cdr, kStamp, "32FC1; compressedDepth png", head + png_of({4041, 0})),
      MessageKind::compressed_image, Wire::cdr);
  EXPECT_FLOAT_EQ(depth_of(metric)->metres(camera).value()(0, 0), 2.0F);
  EXPECT_EQ(depth_of(metric)->metres(camera).value()(1, 0), 0.0F);
  EXPECT_EQ(nature_of(metric).use, PictureUse::depth);
  const auto rvl = stored(
      compressed_message(Wire::ros1, kStamp, "16UC1; compressedDepth rvl", std::string(99, 'x')),
      MessageKind::compressed_image);
  EXPECT_THAT(depth_error(rvl), HasSubstr("RVL; record it as png"));
}

TEST(RosPictures, CompressedColour) {
  const TemporaryFolder folder;
  const ColourImage image(2, 1, {Bgr{1, 2, 3}, Bgr{4, 5, 6}});
  ASSERT_TRUE(write_png(folder / "a.png", image));
  const auto message = stored(compressed_message(Wire::ros1, kStamp, "rgb8; png compressed bgr8",
                                                 read_file(folder / "a.png").value()),
                              MessageKind::compressed_image);
  EXPECT_EQ(colour_of(message)->decode().value()(1, 0), (Bgr{4, 5, 6}));
  EXPECT_EQ(nature_of(message).use, PictureUse::colour);
}

TEST(RosPictures, WrongEncodingsAreNamedWithTheOption) {
  EXPECT_THAT(colour_error(two_pixels("bayer_rggb8", "\1\2")),
              HasSubstr("/topic, message 3: is 'bayer_rggb8'; colour is rgb8, bgr8"));
  EXPECT_THAT(depth_error(two_pixels("rgb8", "\1\2\3\4\5\6")),
              HasSubstr("is 'rgb8'; depth is 16UC1 or 32FC1, or compressedDepth of either as PNG: "
                        "name its topic with --topic-depth"));
  const auto jpeg = stored(compressed_message(Wire::ros1, kStamp, "jpeg", std::string(20, 'x')),
                           MessageKind::compressed_image);
  EXPECT_THAT(depth_error(jpeg), HasSubstr("is 'jpeg'; depth is"));
  EXPECT_THAT(colour_error(jpeg), HasSubstr("/topic, message 3: "));
  EXPECT_EQ(nature_of(two_pixels("bayer_rggb8", "\1\2")).use, PictureUse::neither);
}

TEST(RosPictures, MessagesThatDoNotFitAreRefused) {
  EXPECT_THAT(colour_error(stored("abc", MessageKind::image)), HasSubstr("message is damaged"));
  EXPECT_THAT(depth_error(stored("abc", MessageKind::compressed_image)),
              HasSubstr("message is damaged"));
  const auto short_rows =
      stored(image_message(Wire::ros1, kStamp, 2, 2, "rgb8", 6, "123456"), MessageKind::image);
  EXPECT_THAT(colour_error(short_rows), HasSubstr("2x2 'rgb8' with 6 bytes a row does not fit 6"));
  const auto narrow =
      stored(image_message(Wire::ros1, kStamp, 2, 1, "16UC1", 3, "123456"), MessageKind::image);
  EXPECT_THAT(depth_error(narrow), HasSubstr("does not fit"));
  const auto huge =
      stored(image_message(Wire::ros1, kStamp, 4'000'000'000, 4'000'000'000, "mono8", 0, ""),
             MessageKind::image);
  EXPECT_THAT(colour_error(huge), HasSubstr("does not fit"));
}

CameraInfoMessage info_of(const std::vector<double>& d, const std::string& model = "plumb_bob") {
  const std::string bytes =
      camera_info_message(Wire::cdr, kStamp, 640, 480, 525, 526, 319, 239, d, model);
  return read_camera_info(bytes, Wire::cdr).value();
}

TEST(RosPictures, CamerasByKOrByP) {
  const auto camera = camera_of(info_of({0.1, 0.2, 0.3, 0.4, 0.5}), false);
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->width_px, 640);
  EXPECT_EQ(camera->fy_px, 526);
  EXPECT_EQ(camera->p2, 0.4);
  EXPECT_EQ(camera->k3, 0.5);
  EXPECT_EQ(camera->depth_scale, 1000);
  const auto rectified = camera_of(info_of({0.1, 0.2, 0.3, 0.4, 0.5}), true);
  EXPECT_EQ(rectified->fx_px, 526);
  EXPECT_FALSE(rectified->has_distortion());
}

TEST(RosPictures, LensesThatAreNotOurs) {
  EXPECT_TRUE(camera_of(info_of({0.1, 0, 0, 0, 0, 0, 0, 0}, "rational_polynomial"), false));
  EXPECT_THAT(
      camera_of(info_of({1, 0, 0, 0, 0, 2, 0, 0}, "rational_polynomial"), false).error().message,
      HasSubstr("'rational_polynomial' with more than five coefficients"));
  EXPECT_THAT(camera_of(info_of({0.1, 0, 0, 0}, "equidistant"), false).error().message,
              HasSubstr("is of a lens 'equidistant'"));
  EXPECT_TRUE(camera_of(info_of({0, 0, 0, 0}, "equidistant"), false));
  EXPECT_TRUE(camera_of(info_of({0.1, 0, 0, 0}, "equidistant"), true));
  CameraInfoMessage never = info_of({});
  never.k[0] = 0;
  EXPECT_THAT(camera_of(never, false).error().message, HasSubstr("never calibrated"));
}

TEST(RosMessages, TypesAndStamps) {
  EXPECT_EQ(message_kind("sensor_msgs/Image"), MessageKind::image);
  EXPECT_EQ(message_kind("sensor_msgs/msg/CompressedImage"), MessageKind::compressed_image);
  EXPECT_EQ(message_kind("sensor_msgs/CameraInfo"), MessageKind::camera_info);
  EXPECT_EQ(message_kind("sensor_msgs/msg/Imu"), MessageKind::imu);
  EXPECT_EQ(message_kind("nav_msgs/Odometry"), MessageKind::odometry);
  EXPECT_EQ(message_kind("sensor_msgs/msg/Range"), MessageKind::other);
  EXPECT_EQ(message_kind("my_msgs/Image"), MessageKind::other);
  for (const Wire wire : {Wire::ros1, Wire::cdr}) {
    const std::string bytes = compressed_message(wire, kStamp, "jpeg", "x");
    EXPECT_EQ(header_stamp(bytes.substr(0, kHeaderStart), wire), kStamp);
    EXPECT_FALSE(header_stamp(bytes.substr(0, 6), wire));
  }
}

}  // namespace
}  // namespace ydd
