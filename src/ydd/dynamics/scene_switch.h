// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/detection/detection.h"
#include "ydd/detection/object_catalogue.h"

namespace ydd {

/// Whether any detection is of a dynamic class.
bool has_dynamic_object(const Detections& detections, const ObjectCatalogue& catalogue);

/// Tells static frames from dynamic ones: a frame is static when no dynamic object has been
/// detected for some consecutive frames, itself included.
class SceneSwitch {
 public:
  explicit SceneSwitch(int static_after_frames) : static_after_frames_(static_after_frames) {}

  /// Takes the next frame; true when it is dynamic.
  bool step(bool dynamic_object_detected) {
    frames_without_ = dynamic_object_detected ? 0 : frames_without_ + 1;
    return frames_without_ < static_after_frames_;
  }

 private:
  int static_after_frames_;
  int frames_without_ = 0;
};

}  // namespace ydd
