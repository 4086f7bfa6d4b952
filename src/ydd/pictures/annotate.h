// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/detection/object_catalogue.h"
#include "ydd/image/rgbd_frame.h"
#include "ydd/system/slam_system.h"

namespace ydd {

/// The colour in which points that a rule rejected are drawn; kept points that show a map point are
/// green, others dark green.
Bgr colour_of(Rule rule);

/// What a picture may show besides its frame.
struct AnnotateExtras {
  double frames_per_second = 0;  ///< of the run at that moment; 0: not shown
  ColourImage map;               ///< drawn into the top right corner; may be empty
};

/// The frame's picture with boxes by category, person centres, kept points, rejected points in the
/// colour of their rule (a legend names those that occur), and a line of state. With variant
/// `evidence` also what it found: for each object whether it moves and how likely that is, and a
/// tint over surfaces that do.
ColourImage annotate(const RgbdFrame& frame, const FrameReport& report,
                     const ObjectCatalogue& catalogue, const AnnotateExtras& extras = {});

}  // namespace ydd
