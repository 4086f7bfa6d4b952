// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "run/run_job.h"
#include "ydd/system/slam_system.h"

namespace ydd::app {

/// What encrypts the maps that the request names; empty: nothing does. Read before anything else:
/// a run that cannot save must not begin.
Result<MapKey> run_map_key(const RunRequest& request);

/// The map that a run begins with: all of it, or what is near the camera; neither: it starts anew.
struct RunMap {
  std::optional<Atlas> whole;
  std::unique_ptr<NearbyMap> nearby;
};

/// The map of the request, checked against camera and options of the run. One that is only to be
/// localised in, and larger than `map.near_keyframes`, stays in its file.
Result<RunMap> open_run_map(const RunRequest& request, const MapKey& key, const Camera& camera,
                            const SystemOptions& options);

/// The system that begins with that map.
SlamSystem make_run_system(const Camera& camera, const SystemOptions& options,
                           const ObjectCatalogue& catalogue, std::unique_ptr<Detector> detector,
                           RunMap map);

/// Lets the system save where the request says, and use its map as the request says.
Result<void> prepare_run_map(const RunRequest& request, const MapKey& key, SlamSystem& system);

/// The last save, after the run.
Result<void> save_run_map(const RunRequest& request, SlamSystem& system);

}  // namespace ydd::app
