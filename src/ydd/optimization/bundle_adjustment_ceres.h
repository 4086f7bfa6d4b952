// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/optimization/bundle_adjustment.h"

namespace ydd {

/// The same as `solve_bundle`, through Ceres with analytic derivatives and its Schur solvers on one
/// thread: the reference that our own solver is tested and measured against
/// (docs/adr/0003-own-schur-solver.md). Same phases, gates and results; `iterations` counts steps
/// that Ceres accepted or refused.
BundleResult solve_bundle_ceres(const Camera& camera, const BundleProblem& problem,
                                const BundleOptions& options, const std::stop_token& stop = {});

}  // namespace ydd
