// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "ydd/base/id.h"
#include "ydd/features/features.h"

namespace ydd::python {

/// Points of a frame or keyframe that were judged static; arrays over them keep it alive.
struct KeptPoints {
  std::shared_ptr<const Features> features;
  std::shared_ptr<const std::vector<MapPointId>> points;  ///< per keypoint; may be empty
};

}  // namespace ydd::python
