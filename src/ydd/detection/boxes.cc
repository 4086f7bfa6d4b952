// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/boxes.h"

#include <algorithm>
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
