// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ydd/dynamics/depth_range.h"
#include "ydd/dynamics/dynamics_options.h"
#include "ydd/dynamics/point_rules.h"
#include "ydd/image/image.h"

namespace ydd {

/// The reading that stands for the square cell of `cell_px` whose upper left pixel is (x0, y0): at
/// its centre, else the first found at its four inner corners; 0 when there is none. The cell must
/// lie inside the image.
float cell_reading(const DepthImage& depth_m, int x0_px, int y0_px, int cell_px);

/// Whether a surface goes on from one cell to the next: both have a reading, and these differ by
/// less than `step_share` of the nearer.
bool continuous(float a_m, float b_m, double step_share);

/// What sticks out of the box of a moving body: a limb that the detector cut off, a thing that is
/// carried and was not detected. Beyond the article.
///
/// Looked for are surfaces in the body's depth range that go on across the border of its box. One
/// that ends within `reach_px` of the box gives a region: its bounding box and its depths. One that
/// goes on beyond is furniture, wall or floor and gives none; the image border ends a surface.
/// `bodies` are regions of persons; full rejections have no range and are passed over.
std::vector<MovingRegion> connected_things(const DepthImage& depth_m,
                                           std::span<const MovingRegion> bodies,
                                           const ConnectedObjectOptions& options);

}  // namespace ydd
