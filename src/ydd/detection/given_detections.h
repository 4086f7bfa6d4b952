// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "ydd/base/result.h"
#include "ydd/detection/detection.h"
#include "ydd/detection/object_catalogue.h"

namespace ydd {

/// The smallest box round the pixels of a mask that are not 0; nothing when there are none.
std::optional<Box> box_round(const GreyImage& mask);

/// What a detector outside of the project found in a picture of this size, made into what the rules
/// take: boxes cut to the picture (what lies outside goes), people called as the rules call them
/// (name_in_rules), by falling score. A detection with a mask gets the box round it, and goes when
/// the mask is empty.
///
/// Failure: one line that begins with `source` and tells which detection it is: no class, a score
/// outside [0, 1], a box that is none or reaches far beyond the picture, boxes in fractions of the
/// picture, a mask of another size.
Result<Detections> given_detections(Detections given, const ObjectCatalogue& catalogue,
                                    int width_px, int height_px, const std::string& source);

}  // namespace ydd
