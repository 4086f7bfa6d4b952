// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/scene_switch.h"

#include <algorithm>

namespace ydd {

bool has_dynamic_object(const Detections& detections, const ObjectCatalogue& catalogue) {
  return std::any_of(detections.begin(), detections.end(), [&](const Detection& detection) {
    return category_of(catalogue.subcategory_of(detection.class_name)) == Category::dynamic;
  });
}

}  // namespace ydd
