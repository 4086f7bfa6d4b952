// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ydd/evidence/coarse_depth.h"
#include "ydd/evidence/evidence_options.h"

namespace ydd {

/// The cells of a depth image, gathered into pieces of connected surfaces of limited size, so that
/// evidence is judged over something and not cell by cell.
struct Surfaces {
  std::vector<int> piece;  ///< of each cell; -1: no reading
  int count = 0;           ///< of pieces
};

/// Pieces grow from their first cell in reading order, over steps of depth that one surface can
/// make, up to `patch_radius_m` from it.
Surfaces find_surfaces(const CoarseDepth& depth, std::span<const Eigen::Vector2f> rays,
                       const EvidenceOptions& options);

}  // namespace ydd
