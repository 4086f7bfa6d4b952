// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ydd/map/atlas.h"

namespace ydd {

/// The whole map as text, every number bit by bit (hexadecimal floating point), in slot order: two
/// maps are equal exactly if their dumps are.
std::string dump_map(const Atlas& atlas);

}  // namespace ydd
