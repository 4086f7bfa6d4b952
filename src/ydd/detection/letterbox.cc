// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/letterbox.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace ydd {

Letterbox letterbox_for(int image_width_px, int image_height_px, int input_width_px,
                        int input_height_px) {
  if (std::min({image_width_px, image_height_px, input_width_px, input_height_px}) <= 0) {
    throw std::logic_error("letterbox_for: empty image or input");
  }
  const auto ratio = [](int a, int b) { return static_cast<float>(a) / static_cast<float>(b); };
  Letterbox out;
  out.scale =
      std::min(ratio(input_width_px, image_width_px), ratio(input_height_px, image_height_px));
  const auto scaled = [&](int size_px, int limit_px) {
    const auto rounded = static_cast<int>(std::lround(static_cast<float>(size_px) * out.scale));
    return std::clamp(rounded, 1, limit_px);
  };
  out.width_px = scaled(image_width_px, input_width_px);
  out.height_px = scaled(image_height_px, input_height_px);
  out.offset_x_px = (input_width_px - out.width_px) / 2;
  out.offset_y_px = (input_height_px - out.height_px) / 2;
  return out;
}

Box to_image(const Box& box_input, const Letterbox& letterbox) {
  const auto x = [&](float v) {
    return (v - static_cast<float>(letterbox.offset_x_px)) / letterbox.scale;
  };
  const auto y = [&](float v) {
    return (v - static_cast<float>(letterbox.offset_y_px)) / letterbox.scale;
  };
  return {x(box_input.x0), y(box_input.y0), x(box_input.x1), y(box_input.y1)};
}

struct Letterboxer::Buffers {
  std::vector<float> blob;
  Letterbox place;  // of the picture that is in it
  cv::Mat resized;
  std::array<cv::Mat, 3> channels;
};

Letterboxer::Letterboxer(const InputFormat& format)
    : format_(format), buffers_(std::make_unique<Buffers>()) {
  buffers_->blob.resize(std::size_t{3} * format.width_px * format.height_px);
}

Letterboxer::~Letterboxer() = default;
Letterboxer::Letterboxer(Letterboxer&&) noexcept = default;
Letterboxer& Letterboxer::operator=(Letterboxer&&) noexcept = default;

Tensor Letterboxer::prepare(const ColourImage& image) {
  const Letterbox place =
      letterbox_for(image.width(), image.height(), format_.width_px, format_.height_px);
  if (place != buffers_->place) {
    // Networks are trained with this grey around their pictures.
    constexpr float kGrey = 114.0F;
    std::fill(buffers_->blob.begin(), buffers_->blob.end(), kGrey * format_.value_scale);
    buffers_->place = place;
  }
  // Read only, but a Mat cannot say so.
  const cv::Mat bgr(image.height(), image.width(), CV_8UC3, const_cast<Bgr*>(image.data()));
  const cv::Mat* fitted = &bgr;
  if (place.width_px != image.width() || place.height_px != image.height()) {
    // Linear sampling reads 2 x 2 pixels: below half size it would step over some.
    cv::resize(bgr, buffers_->resized, {place.width_px, place.height_px}, 0, 0,
               place.scale < 0.5F ? cv::INTER_AREA : cv::INTER_LINEAR);
    fitted = &buffers_->resized;
  }
  cv::split(*fitted, buffers_->channels.data());
  const std::size_t plane = std::size_t(format_.width_px) * format_.height_px;
  for (std::size_t c = 0; c < 3; ++c) {
    cv::Mat target(format_.height_px, format_.width_px, CV_32F, buffers_->blob.data() + c * plane);
    cv::Mat inside =
        target(cv::Rect(place.offset_x_px, place.offset_y_px, place.width_px, place.height_px));
    buffers_->channels[format_.rgb ? 2 - c : c].convertTo(inside, CV_32F, format_.value_scale);
  }
  return {{1, 3, format_.height_px, format_.width_px}, buffers_->blob};
}

}  // namespace ydd
