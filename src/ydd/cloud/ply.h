// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "ydd/cloud/dense_cloud.h"

namespace ydd {

/// Clouds as PLY (binary, little endian): float x y z in metres, uchar red green blue.
std::string format_ply(std::span<const CloudPoint> points);

/// The points of one map: float x y z, float nx ny nz (towards where it was seen from), int
/// observations.
std::string format_sparse_ply(const Atlas& atlas, MapId map);

}  // namespace ydd
