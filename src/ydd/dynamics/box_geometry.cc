// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/box_geometry.h"

#include <algorithm>

#include "ydd/detection/boxes.h"

namespace ydd {

bool disjoint(const Box& a, const Box& b) {
  return b.x1 < a.x0 || b.y1 < a.y0 || b.x0 > a.x1 || b.y0 > a.y1;
}

// Erratum: the article prints the intersection's lower right corner with max; it is min.
float coincidence_degree(const Box& a, const Box& b) { return coverage(a, b); }

std::vector<float> largest_coincidence(std::span<const Box> boxes) {
  std::vector<float> degrees(boxes.size(), 0.0F);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t j = 0; j < boxes.size(); ++j) {
      if (i != j) degrees[i] = std::max(degrees[i], coincidence_degree(boxes[i], boxes[j]));
    }
  }
  return degrees;
}

Box scaled(const Box& box, float factor) {
  const float cx = (box.x0 + box.x1) / 2;
  const float cy = (box.y0 + box.y1) / 2;
  const float half_width = box.width() / 2 * factor;
  const float half_height = box.height() / 2 * factor;
  return {cx - half_width, cy - half_height, cx + half_width, cy + half_height};
}

}  // namespace ydd
