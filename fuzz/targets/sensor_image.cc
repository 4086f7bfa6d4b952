// SPDX-License-Identifier: Apache-2.0
#include "ydd/messages/ros_pictures.h"

#include <array>
#include <cmath>

#include "support.h"
#include "targets.h"

namespace ydd::fuzz {
namespace {

template <class T>
void expect_size(const Result<Image<T>>& image, const ImageMessage& from) {
  expect_one_line(image);
  if (!image) return;
  if (image->width() != static_cast<int>(from.width_px) ||
      image->height() != static_cast<int>(from.height_px)) {
    broken("a picture of another size");
  }
}

}  // namespace

// Encoding, byte order, width, height, bytes a row; then the bytes. And a calibration of them.
void sensor_image(std::string_view input) {
  constexpr std::array kEncodings = {"rgb8", "bgr8",  "rgba8",  "bgra8", "mono8", "8UC1",
                                     "8UC3", "16UC1", "mono16", "32FC1", "",      "bayer_rggb8"};
  Pieces pieces(input);
  ImageMessage image;
  image.encoding = kEncodings.at(pieces.byte() % kEncodings.size());
  image.big_endian = pieces.byte() % 2 != 0;
  image.width_px = static_cast<std::uint32_t>(pieces.byte() - 4);
  image.height_px = static_cast<std::uint32_t>(pieces.byte() - 4);
  image.step = static_cast<std::uint32_t>(pieces.byte() * 4);
  const std::string_view bytes = pieces.text(input.size());
  image.data = bytes;
  expect_size(colour_of(image), image);
  const Result<DepthImage> depth = depth_of(image, Camera());
  expect_size(depth, image);
  const int readings = depth ? depth->width() * depth->height() : 0;
  for (int i = 0; i < readings; ++i) {
    const float z_m = depth->data()[i];
    if (!std::isfinite(z_m) || z_m < 0) broken("a reading that is none");
  }
  CameraInfoMessage calibration;
  calibration.width_px = image.width_px;
  calibration.height_px = image.height_px;
  calibration.distortion_model = "plumb_bob";
  for (std::size_t i = 0; i < bytes.size() && i < 9; ++i) {
    calibration.k[i] = 4.0 * static_cast<unsigned char>(bytes[i]);
  }
  for (std::size_t i = 9; i < bytes.size() && i < 20; ++i) {
    calibration.d.push_back(0.01 * (static_cast<unsigned char>(bytes[i]) - 128));
  }
  expect_one_line(camera_of(calibration, false));
}

}  // namespace ydd::fuzz
