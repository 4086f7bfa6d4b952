// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/detection/object_catalogue.h"
#include "ydd/dynamics/judge.h"

namespace ydd {

/// Where a frame may show people, whether they move or not: the boxes of persons, heads and hands
/// that were detected, and of persons who were missed in this frame and are carried on. Pixels of
/// the image as it was taken.
std::vector<Box> people_boxes(const Detections& detections, const Judgement& judgement,
                              const ObjectCatalogue& catalogue);

/// The same box as those see it who must show nothing of a person: grown by `margin_px` and by a
/// share of its size, as boxes of detectors are off by both.
Box around_person(const Box& box, float margin_px);

}  // namespace ydd
