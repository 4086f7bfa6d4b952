// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "ydd/detection/detection.h"

namespace ydd {

/// Area of the intersection over area of the union, in [0, 1]; 0 for empty boxes.
float intersection_over_union(const Box& a, const Box& b);

/// Share of `part` that lies inside `whole`, in [0, 1]; 0 for an empty part. The coincidence
/// degree of the method.
float coverage(const Box& part, const Box& whole);

/// `box` cut to an image of this size.
Box clipped(const Box& box, float width_px, float height_px);

/// All boxes cut to the image; those of which less than a pixel each way remains are left out.
Detections clipped(Detections detections, float width_px, float height_px);

/// Whether more than half a picture of the box lies beyond it: it belongs to a picture of another
/// size.
bool reaches_far_beyond(const Box& box, float width_px, float height_px);
/// Whether nothing of the box lies outside of [0, 1]: it may be in fractions of the picture, ...
bool lies_in_first_pixel(const Box& box);
/// ... unless its sides are whole numbers.
bool has_whole_sides(const Box& box);

/// By falling score, equal scores in the order given.
Detections sorted_by_score(Detections detections);

/// Class-wise non-maximum suppression: keeps a detection unless one of the same class with a higher
/// score overlaps it by more than `iou_threshold`. Gives them by falling score.
Detections suppress_non_maxima(Detections detections, float iou_threshold);

}  // namespace ydd
