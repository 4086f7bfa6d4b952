// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/detection/object_catalogue.h"
#include "ydd/image/rgbd_frame.h"
#include "ydd/system/slam_system.h"

namespace ydd {

/// The colour in which points that a rule rejected are drawn; kept points that show a map point are
/// green, others dark green.
Bgr colour_of(Rule rule);

/// The frame's picture with boxes by category, person centres, kept points, rejected points in the
/// colour of their rule (a legend names those that occur), and a line of state.
ColourImage annotate(const RgbdFrame& frame, const FrameReport& report,
                     const ObjectCatalogue& catalogue);

}  // namespace ydd
