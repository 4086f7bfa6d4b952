// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ydd {

/// A rectangle in pixels, origin top left.
struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;
  int right() const { return x + width; }
  int bottom() const { return y + height; }
};

/// Where the parts of the live window are.
struct WindowLayout {
  PixelRect toolbar;  ///< along the top
  PixelRect picture;  ///< the annotated image, left, with its aspect
  PixelRect charts;   ///< below it
  PixelRect map;      ///< the rest
};

/// For a window of that size and a picture of that aspect (width / height). Sensible from 640x480
/// on; parts never overlap nor leave the window.
WindowLayout layout_window(int width_px, int height_px, double picture_aspect);

}  // namespace ydd
