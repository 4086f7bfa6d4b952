// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/simulation/ray_scene.h"

namespace ydd::sim {

/// Light on a surface at `p` with unit normal `n`, world frame, without shadows: lamps by Lambert's
/// law and a sky that is brighter above.
float open_light(const Scene& scene, const Vector3& p, const Vector3& n);

/// Light at every vertex of the fixed parts, with ambient occlusion and shadows of the lamps cast
/// by fixed things. One vector per part.
std::vector<std::vector<float>> bake_light(const Scene& scene, const RayScene& fixed);

/// How much of each source falls on a place; `itself` has none.
using SourceShares = std::array<float, kLightSources>;

/// As `open_light`, for light that changes. Without sun: it would need shadows.
SourceShares open_shares(const Scene& scene, const Vector3& p, const Vector3& n);

/// As `bake_light`, for light that changes; nothing for parts that shine.
std::vector<std::vector<SourceShares>> bake_shares(const Scene& scene, const RayScene& fixed);

}  // namespace ydd::sim
