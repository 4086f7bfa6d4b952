// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/base/result.h"
#include "ydd/features/features.h"
#include "ydd/geometry/camera.h"

/// Whether what one camera sees fits a map that was made with another.
namespace ydd {

/// How far two cameras with pictures of one size are apart: the farthest, over the picture, that a
/// pixel of `a` lies from where `b` sees its ray, px.
double camera_difference_px(const Camera& a, const Camera& b);

/// Largest difference of two cameras that may share a map, as a share of the picture's width: 4 px
/// of 640, which a focal length of 1 % more gives in the corners. Calibrating a camera again moves
/// it less.
inline constexpr double kCameraTolerance = 4.0 / 640;

/// Whether what `camera` sees can be put into a map made with `of_map`: pictures of one size, rays
/// that differ by at most kCameraTolerance, a virtual baseline within 1 %. Failure: how they
/// differ.
Result<void> check_same_camera(const Camera& of_map, const Camera& camera);
/// The same for the extractor's pyramid.
Result<void> check_same_scales(const PyramidScales& of_map, const PyramidScales& scales);

}  // namespace ydd
