// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "run/run_job.h"
#include "ydd/system/slam_system.h"

namespace ydd::app {

/// What encrypts the maps that the request names; empty: nothing does. Read before anything else:
/// a run that cannot save must not begin.
Result<MapKey> run_map_key(const RunRequest& request);

/// The map that a run goes on with, checked against its camera and options; none: it starts anew.
Result<std::optional<Atlas>> open_run_map(const RunRequest& request, const MapKey& key,
                                          const Camera& camera, const SystemOptions& options);

/// Lets the system save where the request says, and use its map as the request says.
Result<void> prepare_run_map(const RunRequest& request, const MapKey& key, SlamSystem& system);

/// The last save, after the run.
Result<void> save_run_map(const RunRequest& request, SlamSystem& system);

}  // namespace ydd::app
