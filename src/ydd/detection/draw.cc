// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/draw.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace ydd {
namespace {

constexpr double kFontScale = 0.4;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

cv::Scalar scalar(Bgr colour) { return {double(colour[0]), double(colour[1]), double(colour[2])}; }

/// The pixels inside a box: its right and lower borders are just outside it.
cv::Rect pixels_of(const Box& box) {
  const cv::Point first(static_cast<int>(std::floor(box.x0)), static_cast<int>(std::floor(box.y0)));
  const cv::Point last(static_cast<int>(std::ceil(box.x1)), static_cast<int>(std::ceil(box.y1)));
  return {first, last};
}

/// Above the box, or inside it at the top of the image; never beyond the left and right borders.
void draw_label(cv::Mat& canvas, const cv::Rect& box, const std::string& text, Bgr colour) {
  int descent = 0;
  const cv::Size size = cv::getTextSize(text, kFont, kFontScale, 1, &descent);
  const int height = size.height + descent + 2;
  const int x = std::clamp(box.x, 0, std::max(0, canvas.cols - size.width));
  const int top = box.y >= height ? box.y - height : box.y;
  cv::rectangle(canvas, cv::Rect(x, top, size.width, height), scalar(colour), cv::FILLED);
  cv::putText(canvas, text, {x, top + size.height + 1}, kFont, kFontScale, {0, 0, 0}, 1,
              cv::LINE_AA);
}

}  // namespace

Bgr colour_of(Category category) {
  switch (category) {
    case Category::dynamic:
      return {60, 60, 255};
    case Category::potentially_dynamic:
      return {0, 190, 255};
    case Category::stationary:
      break;
  }
  return {90, 200, 90};
}

ColourImage draw_detections(const ColourImage& image, const Detections& detections,
                            const ObjectCatalogue& catalogue) {
  if (image.empty()) return image;
  std::vector<Bgr> pixels(image.data(), image.data() + std::size_t(image.width()) * image.height());
  cv::Mat canvas(image.height(), image.width(), CV_8UC3, pixels.data());
  const Detections weakest_first(detections.rbegin(), detections.rend());
  for (const Detection& d : weakest_first) {  // the strongest end up on top
    const Subcategory subcategory = catalogue.subcategory_of(d.class_name);
    const Bgr colour = colour_of(category_of(subcategory));
    const cv::Rect box = pixels_of(d.box);
    cv::rectangle(canvas, box, scalar(colour), d.sure ? 2 : 1);
    if (subcategory == Subcategory::person) {
      cv::drawMarker(canvas, {box.x + box.width / 2, box.y + box.height / 2}, scalar(colour),
                     cv::MARKER_CROSS, 12, 2);
    }
    draw_label(canvas, box, fmt::format("{} {:.2f}", d.class_name, d.score), colour);
  }
  return {image.width(), image.height(), std::move(pixels)};
}

}  // namespace ydd
