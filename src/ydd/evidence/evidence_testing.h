// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/geometry/camera.h"

namespace ydd::evidence_testing {

/// Without a lens, its axis through the middle of the picture.
inline Camera centred_camera(int width_px, int height_px, double focal_px) {
  Camera camera;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.fx_px = camera.fy_px = focal_px;
  camera.cx_px = 0.5 * (width_px - 1);
  camera.cy_px = 0.5 * (height_px - 1);
  return camera;
}

/// 20 x 15 cells of 8 px; at 2 m a cell is 0.1 m wide.
inline Camera small_camera() { return centred_camera(160, 120, 160); }

}  // namespace ydd::evidence_testing
