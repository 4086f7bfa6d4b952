// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "binding.h"
#include "ydd/map/atlas.h"

namespace ydd::python {

/// One map of an atlas, as it was at some time.
struct Map {
  std::shared_ptr<const Atlas> atlas;  ///< never null
  MapId id;                            ///< invalid: there is none yet, and it is empty
};

/// The map with most keyframes, or an empty one.
Map largest_map(std::shared_ptr<const Atlas> atlas);

}  // namespace ydd::python
