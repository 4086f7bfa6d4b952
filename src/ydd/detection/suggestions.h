// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "ydd/detection/detection.h"

/// Which frames of a recording are worth a person's correction, and their boxes for training/.
namespace ydd {

/// Boxes from here on are proposed as true; weaker ones as regions of which nothing is known.
constexpr float kProposedScore = 0.3F;

/// How unsure a network is of a frame: the sum over its boxes of 4 s (1 - s), the variance of "is
/// it there?" with the score s as odds, 1 at most for a box. 0 for no boxes.
double doubt(const Detections& detections);

/// The `count` positions of most doubt, in rising order; no two nearer than `gap` positions, the
/// better one stays. Frames without any doubt are never chosen.
std::vector<std::size_t> most_doubtful(std::span<const double> doubts, std::size_t count,
                                       std::size_t gap);

/// One line of JSON as the training reads it: {"boxes": [[class, x0, y0, x1, y1]], "ignore":
/// [...]}. Classes are written as they are named.
std::string training_labels(const Detections& detections);

}  // namespace ydd
