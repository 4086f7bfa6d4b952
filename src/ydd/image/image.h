// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace ydd {

/// An immutable picture: a value whose copies share pixels that nobody can write any more.
/// Rows are contiguous. (A const cv::Mat is not immutable: its copies share writable pixels.)
template <class T>
class Image {
 public:
  Image() = default;
  /// Takes `pixels`, row by row. @throws std::logic_error unless there are width * height of them.
  Image(int width_px, int height_px, std::vector<T> pixels) : width_(width_px), height_(height_px) {
    if (width_ < 0 || height_ < 0 || pixels.size() != std::size_t(width_) * height_) {
      throw std::logic_error("Image: pixel count does not match its size");
    }
    const auto owner = std::make_shared<const std::vector<T>>(std::move(pixels));
    pixels_ = {owner, owner->data()};
  }
  /// Shares pixels that somebody else holds: width * height of them, which nobody may write any
  /// more. The last copy lets go of them, in whatever thread it ends.
  Image(int width_px, int height_px, std::shared_ptr<const T> pixels)
      : width_(width_px), height_(height_px), pixels_(std::move(pixels)) {
    if (width_ < 0 || height_ < 0 || (!pixels_ && !empty())) {
      throw std::logic_error("Image: no pixels");
    }
  }

  bool empty() const { return width_ == 0 || height_ == 0; }  ///< Whether it has no pixel.
  int width() const { return width_; }                        ///< Pixels in a row.
  int height() const { return height_; }                      ///< Number of rows.
  /// Whether a whole pixel position lies on it.
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }

  /// The first pixel; rows follow without gaps. Null when it is empty.
  const T* data() const { return pixels_.get(); }
  /// The first pixel of row `y`. Unchecked.
  const T* row(int y) const { return data() + static_cast<std::size_t>(y) * width_; }
  /// Unchecked.
  const T& operator()(int x, int y) const { return row(y)[x]; }

 private:
  int width_ = 0;
  int height_ = 0;
  std::shared_ptr<const T> pixels_;  ///< the first one
};

using Bgr = std::array<std::uint8_t, 3>;  ///< Blue, green, red.
using GreyImage = Image<std::uint8_t>;    ///< Brightness, 0 to 255.
using ColourImage = Image<Bgr>;           ///< As OpenCV orders it: blue, green, red.
/// Depth along the optical axis in metres; 0 is *no reading*.
using DepthImage = Image<float>;
/// Depth as stored in a file: counts of 1 / Camera::depth_scale metres, 0 is *no reading*.
using RawDepthImage = Image<std::uint16_t>;

}  // namespace ydd
