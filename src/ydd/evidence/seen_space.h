// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ydd/evidence/coarse_depth.h"
#include "ydd/evidence/evidence_options.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// What an earlier frame says of the place where a cell's surface is now.
enum class Space : std::uint8_t {
  unknown,  ///< out of view, or no reading
  hidden,   ///< it lay behind something: newly uncovered, no evidence
  same,     ///< there was a surface just there
  empty,    ///< the earlier frame looked through it: what is there now has come
};

/// For each cell of `now` what `then` says of its place. `T_then_now` maps from the camera frame of
/// now to that of then. Only what no reading around the place contradicts is called empty, so that
/// edges and an error of the pose of some millimetres are no evidence.
std::vector<Space> space_then(const CoarseDepth& now, const CoarseDepth& then,
                              const SE3& T_then_now, const Camera& camera,
                              std::span<const Eigen::Vector2f> rays,
                              const EvidenceOptions& options);

}  // namespace ydd
