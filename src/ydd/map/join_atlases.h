// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/base/result.h"
#include "ydd/map/atlas.h"

namespace ydd {

/// Both in one: ids, serials and map numbers of `a` stay, those of `b` follow after them. No two
/// maps are merged. Failure: cameras or pyramids differ.
Result<Atlas> join_atlases(const Atlas& a, const Atlas& b);

}  // namespace ydd
