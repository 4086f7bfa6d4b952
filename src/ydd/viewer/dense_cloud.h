// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include "ydd/viewer/map_scene.h"

namespace ydd {

/// The static surfaces that one frame saw, in their own colours.
struct DensePatch {
  KeyFrameId reference;
  SE3 T_reference_camera;
  Vertices points;  ///< in the camera's frame, not the world's: a corrected map moves them
};

/// Every `step_px`-th pixel with a depth reading nearer than `farthest_m` that lies on nothing that
/// was judged to move: outside the depth ranges of moving objects and away from rejected points.
/// Camera frame.
Vertices static_surface(const RgbdFrame& frame, const FrameReport& report, const Camera& camera,
                        int step_px = 5, double farthest_m = 4.5);

/// Collects patches from frames that look at something new. Only frames that are shown to it count;
/// the oldest patch goes when there are too many.
class DenseCloud {
 public:
  static constexpr std::size_t kMostPatches = 60;

  /// True when the frame's surface was added.
  bool add(const LiveFrame& live, const Camera& camera);
  void clear() { patches_.clear(); }
  const std::deque<DensePatch>& patches() const { return patches_; }

 private:
  std::deque<DensePatch> patches_;
};

}  // namespace ydd
