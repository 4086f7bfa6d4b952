// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ydd/evidence/coarse_depth.h"
#include "ydd/evidence/evidence_options.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// For each cell of a frame the odds that what is seen there moves. Positive: more likely than not.
struct MotionOdds {
  CoarseDepth depth;                ///< the frame's depth by cells of 8 px
  std::vector<float> log_odds;      ///< natural logarithm; 0: nothing known
  std::vector<float> prior;         ///< by the class of what was detected there; empty: nothing was
  std::vector<std::uint8_t> moves;  ///< the verdict, with hysteresis

  std::vector<float> calm_s;  ///< for how long nothing has spoken for motion

  /// Whether nothing was looked at: no frame, or none with depth.
  bool empty() const { return log_odds.empty(); }

  /// The cell around a pixel of the image as it was taken whose surface a reading of `depth_m` lies
  /// on (0: the pixel's own cell); -1: none.
  int cell_at(float x_px, float y_px, float depth_m) const;

  /// Whether something that stands still at `depth_m` cannot be seen there: the camera looks
  /// through its place, or a surface there moves. `tolerance_m` is of depth.
  bool contradicts(float x_px, float y_px, float depth_m, float tolerance_m) const;
};

/// What was known of the surfaces of `before`, where they are in the next frame if they stand
/// still: log-odds and verdicts for the cells of `depth`. Surfaces that were not seen: nothing
/// known.
MotionOdds carried_odds(const MotionOdds& before, CoarseDepth depth, const SE3& T_before_now,
                        const Camera& camera, std::span<const Eigen::Vector2f> rays,
                        const EvidenceOptions& options);

}  // namespace ydd
