// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/redact.h"

#include <algorithm>
#include <cmath>

#include "ydd/dynamics/people_boxes.h"

namespace ydd {
namespace {

constexpr float kBoxMargin_px = 12.0F;   // as in the pictures of keyframes, which are half as large
constexpr float kCellMargin_px = 12.0F;  // around a cell that moves

std::vector<Box> hidden_boxes(const FrameReport& report, const ObjectCatalogue& catalogue) {
  std::vector<Box> boxes;
  for (const Box& box : people_boxes(report.detections, report.judgement, catalogue)) {
    boxes.push_back(around_person(box, kBoxMargin_px));
  }
  if (!report.odds) return boxes;
  const CellGrid& grid = report.odds->depth.grid;
  const auto side_px = static_cast<float>(grid.cell_px);
  for (std::size_t i = 0; i < report.odds->moves.size(); ++i) {
    if (report.odds->moves[i] == 0) continue;
    const Eigen::Vector2f at_px = grid.corner_px(i);
    const Box cell{at_px.x(), at_px.y(), at_px.x() + side_px, at_px.y() + side_px};
    boxes.push_back(grown(cell, kCellMargin_px));
  }
  return boxes;
}

/// A copy with zeros in the boxes; of no pixels none.
template <class Pixel>
Image<Pixel> without(const Image<Pixel>& image, const std::vector<Box>& boxes) {
  if (image.empty()) return image;
  const std::size_t count = static_cast<std::size_t>(image.width()) * image.height();
  std::vector<Pixel> pixels(image.data(), image.data() + count);
  for (const Box& box : boxes) {
    const auto bound = [](float px, int size) {
      return std::clamp(static_cast<int>(std::floor(px)), 0, size);
    };
    const int x0 = bound(box.x0, image.width());
    const int x1 = bound(box.x1 + 1.0F, image.width());
    for (int y = bound(box.y0, image.height()); y < bound(box.y1 + 1.0F, image.height()); ++y) {
      const auto row = pixels.begin() + static_cast<std::ptrdiff_t>(y) * image.width();
      std::fill(row + x0, row + std::max(x0, x1), Pixel{});
    }
  }
  return {image.width(), image.height(), std::move(pixels)};
}

}  // namespace

RgbdFrame redacted(const RgbdFrame& frame, const FrameReport& report,
                   const ObjectCatalogue& catalogue) {
  const std::vector<Box> boxes = hidden_boxes(report, catalogue);
  if (boxes.empty()) return frame;
  return {frame.index, frame.stamp, without(frame.grey, boxes), without(frame.colour, boxes),
          without(frame.depth_m, boxes)};
}

}  // namespace ydd
