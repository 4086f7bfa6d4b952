// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/image/image.h"

namespace ydd {

/// The picture in another size: each new pixel is the mean of the area that it covers. Meant for
/// making smaller; a factor that is no whole number is allowed. Pixel centres at integers: old
/// (u + 0.5) / old size = new (u + 0.5) / new size. @throws std::logic_error for an empty size.
ColourImage resized(const ColourImage& image, int width_px, int height_px);

}  // namespace ydd
