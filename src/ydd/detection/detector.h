// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ydd/base/result.h"
#include "ydd/detection/detection.h"
#include "ydd/image/rgbd_frame.h"

namespace ydd {

/// Finds objects in a frame. Thread: one call at a time, any thread.
class Detector {
 public:
  virtual ~Detector() = default;
  /// Detections sorted by falling score. Fails when the frame cannot be judged at all (a recording
  /// without this frame, a network that breaks).
  virtual Result<Detections> detect(const RgbdFrame& frame) = 0;
  /// Where its networks are computed (InferenceSession::device()); empty: it has none.
  virtual std::string device() const { return {}; }
};

}  // namespace ydd
