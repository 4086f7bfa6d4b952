// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/features/orb_kernels.h"
#include "ydd/features/orb_pyramid.h"

namespace ydd {

/// Orientation of the patch around pixel (x, y): the angle of the vector from the pixel to the
/// intensity centroid of the disc, in [0, 2 pi), x axis towards y axis. The disc must lie within
/// the image, and one more column on its right. Rublee et al., ICCV 2011, section 3.2; Rosin,
/// "Measuring corner properties", 1999.
float intensity_centroid_angle_rad(const GreyView& view, int x, int y);

/// atan2 to 1e-6 rad, in [0, 2 pi); 0 for (0, 0).
float fast_atan2_rad(float y, float x);

}  // namespace ydd
