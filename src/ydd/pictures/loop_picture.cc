// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/loop_picture.h"

#include <map>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace ydd {
namespace {

cv::Point pixel(const Keypoint& k, int shift_px) {
  return {cvRound(k.x_px) + shift_px, cvRound(k.y_px)};
}

std::vector<Bgr> side_by_side(const ColourImage& left, const ColourImage& right) {
  std::vector<Bgr> pixels;
  pixels.reserve(2U * std::size_t(left.width()) * static_cast<std::size_t>(left.height()));
  for (int y = 0; y < left.height(); ++y) {
    pixels.insert(pixels.end(), left.row(y), left.row(y) + left.width());
    pixels.insert(pixels.end(), right.row(y), right.row(y) + right.width());
  }
  return pixels;
}

void draw_points(cv::Mat& canvas, const KeyFrame& keyframe, int shift_px) {
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    if (!keyframe.points[i].valid()) continue;
    cv::circle(canvas, pixel(keyframe.features().keypoints[i], shift_px), 2, {0, 255, 0},
               cv::FILLED, cv::LINE_AA);
  }
}

void draw_shared(cv::Mat& canvas, const KeyFrame& left, const KeyFrame& right, int shift_px) {
  std::map<MapPointId, std::size_t> of_left;
  for (std::size_t i = 0; i < left.points.size(); ++i) {
    if (left.points[i].valid()) of_left.emplace(left.points[i], i);
  }
  for (std::size_t i = 0; i < right.points.size(); ++i) {
    const auto it = of_left.find(right.points[i]);
    if (it == of_left.end()) continue;
    cv::line(canvas, pixel(left.features().keypoints[it->second], 0),
             pixel(right.features().keypoints[i], shift_px), {0, 220, 255}, 1, cv::LINE_AA);
  }
}

}  // namespace

ColourImage loop_picture(const LoopReport& loop, const Atlas& atlas, const ColourImage& matched,
                         const ColourImage& current) {
  if (matched.width() != current.width() || matched.height() != current.height()) return {};
  std::vector<Bgr> pixels = side_by_side(matched, current);
  cv::Mat canvas(matched.height(), 2 * matched.width(), CV_8UC3, pixels.data());
  const KeyFrame* const left = atlas.find(loop.matched);
  const KeyFrame* const right = atlas.find(loop.current);
  if (left && right) draw_shared(canvas, *left, *right, matched.width());
  if (left) draw_points(canvas, *left, 0);
  if (right) draw_points(canvas, *right, matched.width());
  return {canvas.cols, canvas.rows, std::move(pixels)};
}

}  // namespace ydd
