// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/people_boxes.h"

#include <algorithm>

namespace ydd {

std::vector<Box> people_boxes(const Detections& detections, const Judgement& judgement,
                              const ObjectCatalogue& catalogue) {
  std::vector<Box> boxes;
  for (const Detection& detection : detections) {
    const Subcategory kind = catalogue.subcategory_of(detection.class_name);
    if (kind == Subcategory::person || kind == Subcategory::head || kind == Subcategory::hand) {
      boxes.push_back(detection.box);
    }
  }
  for (const MovingRegion& region : judgement.regions) {
    if (region.rule == Rule::bridged) boxes.push_back(region.box);
  }
  return boxes;
}

Box around_person(const Box& box, float margin_px) {
  constexpr float kShare = 0.05F;  // of the longer side
  return grown(box, margin_px + kShare * std::max(box.width(), box.height()));
}

}  // namespace ydd
