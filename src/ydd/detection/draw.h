// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/detection/detection.h"
#include "ydd/detection/object_catalogue.h"
#include "ydd/image/image.h"

namespace ydd {

/// What boxes look like: dynamic red, potentially dynamic amber, static green.
Bgr colour_of(Category category);

/// A copy of `image` with the boxes in the colour of their category, class name and score beside
/// them, and a cross at the centre of each person. What leaves the image is cut off.
ColourImage draw_detections(const ColourImage& image, const Detections& detections,
                            const ObjectCatalogue& catalogue);

}  // namespace ydd
