// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "binding.h"
#include "ydd/map/atlas.h"
#include "ydd/map_files/map_key.h"

namespace ydd::python {

/// One map of an atlas, as it was at some time.
struct Map {
  std::shared_ptr<const Atlas> atlas;  ///< a snapshot; never null
  MapId id;                            ///< invalid: there is none yet, and it is empty
};

/// What Python gives as map_key: the name of a file, the key itself as bytes, or None for what the
/// environment says.
MapKey map_key_from(const py::object& given);

/// The map with most keyframes, or an empty one.
Map largest_map(std::shared_ptr<const Atlas> atlas);

/// A copy, for somebody who goes on with it, of all maps of its run: what it does not change is
/// shared. None: it is empty.
std::optional<Atlas> atlas_of(const Map& map);

}  // namespace ydd::python
