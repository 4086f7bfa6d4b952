// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ydd/detection/detection.h"

namespace ydd {

/// Whether the boxes have no point in common; boxes that touch do not count as disjoint (article,
/// equation 2).
bool disjoint(const Box& a, const Box& b);
inline bool intersect(const Box& a, const Box& b) { return !disjoint(a, b); }

/// `area(a and b) / area(a)` (article, equation 3); 0 for an empty a.
float coincidence_degree(const Box& a, const Box& b);

/// For each box the largest coincidence degree with any other of them.
std::vector<float> largest_coincidence(std::span<const Box> boxes);

/// The box scaled about its centre.
Box scaled(const Box& box, float factor);

}  // namespace ydd
