// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ydd/map/atlas.h"

namespace ydd {

/// The whole map as text, every number bit by bit (hexadecimal floating point), in slot order; of
/// keypoints and pictures a checksum. Two maps are equal if their dumps are.
std::string dump_map(const Atlas& atlas);

}  // namespace ydd
