// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "ydd/geometry/camera.h"
#include "ydd/geometry/se3.h"
#include "ydd/image/rgbd_frame.h"

/// The simplest world with pictures: a patterned wall, parallel to the image, past which the camera
/// moves by whole pixels a frame. Exact without any rendering.
namespace ydd::testing_world {

class Wall {
 public:
  static constexpr double kDistance_m = 2.0;

  /// Long enough for `frames` frames at `pixels_per_frame`.
  explicit Wall(int frames, int pixels_per_frame = 2, unsigned seed = 1)
      : step_px_(pixels_per_frame), width_px_(320 + frames * pixels_per_frame) {
    camera_.width_px = 320;
    camera_.height_px = 240;
    camera_.fx_px = camera_.fy_px = 260;
    camera_.cx_px = 159.5;
    camera_.cy_px = 119.5;
    grey_.assign(static_cast<std::size_t>(width_px_) * 240U, 100);
    std::mt19937 random(seed);
    for (int i = 0; i < width_px_ * 3; ++i) {
      paint(static_cast<int>(random() % static_cast<unsigned>(width_px_)),
            static_cast<int>(random() % 240U), 3 + static_cast<int>(random() % 9U),
            3 + static_cast<int>(random() % 9U), static_cast<std::uint8_t>(random() % 256U));
    }
  }

  const Camera& camera() const { return camera_; }
  SE3 T_world_camera(int index) const {
    return {Eigen::Quaterniond::Identity(), {index * step_px_ * kDistance_m / camera_.fx_px, 0, 0}};
  }
  Timestamp stamp(int index) const { return {1'000'000'000LL + index * 33'333'333LL}; }

  RgbdFrame frame(int index) const {
    std::vector<std::uint8_t> grey;
    std::vector<Bgr> colour;
    grey.reserve(320U * 240U);
    colour.reserve(320U * 240U);
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 320; ++x) {
        const std::uint8_t g = at(x + index * step_px_, y);
        grey.push_back(g);
        colour.push_back({g, g, g});
      }
    }
    RgbdFrame out;
    out.index = index;
    out.stamp = stamp(index);
    out.grey = GreyImage(320, 240, std::move(grey));
    out.colour = ColourImage(320, 240, std::move(colour));
    out.depth_m = DepthImage(320, 240, std::vector<float>(320U * 240U, 2.0F));
    return out;
  }
  /// A frame with nothing to see.
  RgbdFrame dark_frame(int index) const {
    RgbdFrame out = frame(index);
    out.grey = GreyImage(320, 240, std::vector<std::uint8_t>(320U * 240U, 0));
    out.depth_m = DepthImage(320, 240, std::vector<float>(320U * 240U, 0.0F));
    return out;
  }

 private:
  std::uint8_t at(int x, int y) const {
    return grey_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px_) +
                 static_cast<std::size_t>(x)];
  }
  void paint(int x0, int y0, int width, int height, std::uint8_t value) {
    for (int y = y0; y < std::min(240, y0 + height); ++y) {
      for (int x = x0; x < std::min(width_px_, x0 + width); ++x) {
        grey_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px_) +
              static_cast<std::size_t>(x)] = value;
      }
    }
  }

  int step_px_;
  int width_px_;
  Camera camera_;
  std::vector<std::uint8_t> grey_;
};

}  // namespace ydd::testing_world
