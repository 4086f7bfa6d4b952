// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ydd/evidence/coarse_depth.h"
#include "ydd/evidence/evidence_options.h"
#include "ydd/evidence/seen_from.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// What an earlier frame says of the place where a cell's surface is now.
enum class Space : std::uint8_t {
  unknown,  ///< out of view, or no reading
  hidden,   ///< it lay behind something: newly uncovered, no evidence
  same,     ///< there was a surface just there
  empty,    ///< the earlier frame looked through it: what is there now has come
};

/// For each of the points `now` what `then` says of its place. `T_then_now` maps from the camera
/// frame of now to that of then. Only what no reading around the place contradicts is called empty,
/// so that edges and an error of the pose of some millimetres are no evidence. `places` is room to
/// work in.
void space_then(const PointList& now, const CoarseDepth& then, const SE3& T_then_now,
                const Camera& camera, const EvidenceOptions& options, SeenFrom::Places& places,
                std::vector<Space>& out);

}  // namespace ydd
