// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/geometry/camera.h"

namespace ydd::evidence_testing {

/// 20 x 15 cells of 8 px; at 2 m a cell is 0.1 m wide.
inline Camera small_camera() {
  Camera camera;
  camera.width_px = 160;
  camera.height_px = 120;
  camera.fx_px = camera.fy_px = 160;
  camera.cx_px = 79.5;
  camera.cy_px = 59.5;
  return camera;
}

}  // namespace ydd::evidence_testing
