// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ydd/image/rgbd_frame.h"

namespace ydd {

/// Notices that one of the two cameras stands still: its picture comes again and again, equal to
/// the pixel, while the other one goes on. Two repeats are no fault: a depth camera may be slower
/// than the colour camera. Thread: one.
class RepeatedPictures {
 public:
  /// What is to be thought of a frame.
  struct Verdict {
    bool stale = false;  ///< one picture is that of the frame before: nothing to keep
    std::string doubt;   ///< why it cannot be what the camera sees now; empty: no reason
  };
  /// Frames come in order.
  Verdict look(const RgbdFrame& frame);

 private:
  ColourImage colour_;  ///< of the frame before; empty: none
  DepthImage depth_m_;
  int colour_repeats_ = 0;
  int depth_repeats_ = 0;
};

}  // namespace ydd
