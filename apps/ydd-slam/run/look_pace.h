// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "ydd/dataset/sequence.h"
#include "ydd/detection/detector.h"
#include "ydd/system/detector_runner.h"

namespace ydd::app {

/// How long the detector looks at one picture, and how often the camera gives one.
struct LookPace {
  double look_ms = 0;
  double interval_ms = 0;
};

/// Lets the detector look at the first picture of the sequence. Nothing when it cannot, or when
/// there is only one picture: the run itself will say why.
std::optional<LookPace> measure_look(Detector& detector, const Sequence& sequence,
                                     const Camera& camera);

struct DetectChoice {
  DetectMode mode = DetectMode::every_frame;  ///< or asynchronous
  std::string message;                        ///< for the user; empty: nothing to say
};

/// Decides between the modes auto and every-frame: a run that keeps the camera's pace does not wait
/// for a detector that cannot. `cores` are those that the process may use: on a single one, looking
/// and tracking take turns.
DetectChoice choose_detect_mode(DetectMode mode, const LookPace& pace, bool realtime, int cores);

}  // namespace ydd::app
