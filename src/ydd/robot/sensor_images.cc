// SPDX-License-Identifier: Apache-2.0
#include "ydd/robot/sensor_images.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <vector>

#include <fmt/format.h>

namespace ydd {
namespace {

/// Where the channels of a colour encoding are.
struct Layout {
  std::size_t channels = 0, blue = 0, green = 0, red = 0;
};

std::optional<Layout> layout_of(const std::string& encoding) {
  if (encoding == "bgr8" || encoding == "8UC3") return Layout{3, 0, 1, 2};
  if (encoding == "rgb8") return Layout{3, 2, 1, 0};
  if (encoding == "bgra8" || encoding == "8UC4") return Layout{4, 0, 1, 2};
  if (encoding == "rgba8") return Layout{4, 2, 1, 0};
  if (encoding == "mono8" || encoding == "8UC1") return Layout{1, 0, 0, 0};
  return std::nullopt;
}

/// Whether all rows are there.
Result<void> check_size(const SensorImage& image, std::size_t pixel_bytes) {
  constexpr int kMost_px = 20000;
  const bool fits =
      image.width_px > 0 && image.height_px > 0 && image.width_px <= kMost_px &&
      image.height_px <= kMost_px &&
      image.step_bytes >= pixel_bytes * static_cast<std::size_t>(image.width_px) &&
      image.bytes.size() / image.step_bytes >= static_cast<std::size_t>(image.height_px);
  if (fits) return {};
  return Error{fmt::format(
      "a picture of {} x {} px in {} with {} bytes a row and {} in all: the "
      "message is damaged",
      image.width_px, image.height_px, image.encoding, image.step_bytes, image.bytes.size())};
}

template <class T>
T value_at(const std::uint8_t* at, bool swap) {
  std::array<std::uint8_t, sizeof(T)> bytes;
  std::memcpy(bytes.data(), at, sizeof(T));
  if (swap) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

/// `metres_of(value)` of every pixel, 0 where the camera cannot have read it.
template <class T, class Metres>
DepthImage depth_from(const SensorImage& image, const Camera& camera, Metres metres_of) {
  const bool swap = image.big_endian != (std::endian::native == std::endian::big);
  std::vector<float> depth_m;
  depth_m.reserve(static_cast<std::size_t>(image.width_px) *
                  static_cast<std::size_t>(image.height_px));
  for (int y = 0; y < image.height_px; ++y) {
    const std::uint8_t* const row =
        image.bytes.data() + static_cast<std::size_t>(y) * image.step_bytes;
    for (int x = 0; x < image.width_px; ++x) {
      const float z_m = metres_of(value_at<T>(row + static_cast<std::size_t>(x) * sizeof(T), swap));
      const bool read = std::isfinite(z_m) && camera.is_valid_depth(static_cast<double>(z_m));
      depth_m.push_back(read ? z_m : 0.0F);
    }
  }
  return {image.width_px, image.height_px, std::move(depth_m)};
}

}  // namespace

Result<ColourImage> colour_of(const SensorImage& image) {
  const std::optional<Layout> layout = layout_of(image.encoding);
  if (!layout) {
    return Error{
        fmt::format("colour images in '{}' are not read; rgb8, bgr8, rgba8, bgra8 and "
                    "mono8 are",
                    image.encoding)};
  }
  if (auto r = check_size(image, layout->channels); !r) return r.error();
  std::vector<Bgr> pixels;
  pixels.reserve(static_cast<std::size_t>(image.width_px) *
                 static_cast<std::size_t>(image.height_px));
  for (int y = 0; y < image.height_px; ++y) {
    const std::uint8_t* at = image.bytes.data() + static_cast<std::size_t>(y) * image.step_bytes;
    for (int x = 0; x < image.width_px; ++x, at += layout->channels) {
      pixels.push_back({at[layout->blue], at[layout->green], at[layout->red]});
    }
  }
  return ColourImage(image.width_px, image.height_px, std::move(pixels));
}

Result<DepthImage> depth_of(const SensorImage& image, const Camera& camera) {
  if (image.encoding == "16UC1" || image.encoding == "mono16") {
    if (auto r = check_size(image, sizeof(std::uint16_t)); !r) return r.error();
    return depth_from<std::uint16_t>(
        image, camera, [](std::uint16_t mm) { return 0.001F * static_cast<float>(mm); });
  }
  if (image.encoding == "32FC1") {
    if (auto r = check_size(image, sizeof(float)); !r) return r.error();
    return depth_from<float>(image, camera, [](float m) { return m; });
  }
  return Error{
      fmt::format("depth images in '{}' are not read; 16UC1 (millimetres) and 32FC1 (metres) are",
                  image.encoding)};
}

Result<Camera> camera_of(const SensorCalibration& calibration) {
  if (calibration.K[0] == 0 || calibration.K[4] == 0) {
    return Error{
        "camera_info holds no calibration (K is 0); calibrate the camera or name a camera "
        "file"};
  }
  const std::string& model = calibration.distortion_model;
  const bool straight =
      std::all_of(calibration.D.begin(), calibration.D.end(), [](double d) { return d == 0; });
  if (!straight && model != "plumb_bob") {
    return Error{fmt::format("camera_info has the lens model '{}'; plumb_bob is read", model)};
  }
  if (calibration.D.size() > 5 && !straight) {
    return Error{fmt::format("camera_info has {} distortion coefficients; plumb_bob has 5",
                             calibration.D.size())};
  }
  Camera camera;
  camera.name = "camera_info";
  camera.width_px = calibration.width_px;
  camera.height_px = calibration.height_px;
  camera.fx_px = calibration.K[0];
  camera.cx_px = calibration.K[2];
  camera.fy_px = calibration.K[4];
  camera.cy_px = calibration.K[5];
  camera.depth_scale = 1000;
  double* const coefficients[] = {&camera.k1, &camera.k2, &camera.p1, &camera.p2, &camera.k3};
  for (std::size_t i = 0; i < std::min<std::size_t>(5, calibration.D.size()); ++i) {
    *coefficients[i] = calibration.D[i];
  }
  if (auto r = check_camera(camera); !r) {
    return Error{"camera_info: " + r.error().message};
  }
  return camera;
}

}  // namespace ydd
