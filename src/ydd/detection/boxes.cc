// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/boxes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ydd {

float intersection_over_union(const Box& a, const Box& b) {
  const float common = intersection(a, b).area();
  return common > 0.0F ? common / (a.area() + b.area() - common) : 0.0F;
}

float coverage(const Box& part, const Box& whole) {
  const float area = part.area();
  return area > 0.0F ? intersection(part, whole).area() / area : 0.0F;
}

Box clipped(const Box& box, float width_px, float height_px) {
  return intersection(box, {0.0F, 0.0F, width_px, height_px});
}

Detections clipped(Detections detections, float width_px, float height_px) {
  for (Detection& d : detections) d.box = clipped(d.box, width_px, height_px);
  std::erase_if(detections,
                [](const Detection& d) { return d.box.width() < 1.0F || d.box.height() < 1.0F; });
  return detections;
}

bool reaches_far_beyond(const Box& box, float width_px, float height_px) {
  return box.x0 < -0.5F * width_px || box.y0 < -0.5F * height_px || box.x1 > 1.5F * width_px ||
         box.y1 > 1.5F * height_px;
}

bool lies_in_first_pixel(const Box& box) {
  return box.x0 >= 0 && box.y0 >= 0 && box.x1 <= 1 && box.y1 <= 1;
}

bool has_whole_sides(const Box& box) {
  const auto is_whole = [](float v) { return v == std::floor(v); };
  return is_whole(box.x0) && is_whole(box.y0) && is_whole(box.x1) && is_whole(box.y1);
}

Detections sorted_by_score(Detections detections) {
  std::stable_sort(detections.begin(), detections.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  return detections;
}

Detections suppress_non_maxima(Detections detections, float iou_threshold) {
  Detections kept;
  for (Detection& candidate : sorted_by_score(std::move(detections))) {
    const bool suppressed = std::any_of(kept.begin(), kept.end(), [&](const Detection& better) {
      return better.class_name == candidate.class_name &&
             intersection_over_union(better.box, candidate.box) > iou_threshold;
    });
    if (!suppressed) kept.push_back(std::move(candidate));
  }
  return kept;
}

}  // namespace ydd
