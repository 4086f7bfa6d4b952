// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "ydd/base/result.h"
#include "ydd/geometry/alignment.h"

namespace ydd {

/// People and moving things for a page, those with most frames first: {id, class, stamp_s, xyz,
/// first_s, last_s, seen, way_m, mean_m_s, top_m_s, moving, extent_m}. `jsonl` has a line of tracks
/// per frame (docs/robot.md), positions are shown where `to_world` puts them; an empty text has no
/// tracks. Places in which one was not seen are left out. Failure: names the line.
Result<nlohmann::ordered_json> tracks_json(const std::string& jsonl, const Alignment& to_world);

}  // namespace ydd
