// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "ydd/dynamics/point_rules.h"
#include "ydd/image/image.h"

namespace ydd {

/// Approximate minimum depth of what the other regions leave of the box of region `index`: readings
/// on a grid over the box, without those that lie in the box and range of another region (full
/// rejections explain nothing); of the rest the nearest decile. Nothing when less than
/// `least_share` of the readings are left. Beyond the article: of two persons of whom one hides the
/// other, the nearer one explains its own readings, and what is left begins with the farther one.
std::optional<float> unexplained_depth(const DepthImage& depth_m, std::size_t index,
                                       std::span<const MovingRegion> regions, double least_share);

}  // namespace ydd
