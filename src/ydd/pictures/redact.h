// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/detection/object_catalogue.h"
#include "ydd/image/rgbd_frame.h"
#include "ydd/system/slam_system.h"

namespace ydd {

/// The frame as others may see it: black and without depth in every box in which there may be
/// somebody (people_boxes, grown by a margin), whether they move or not, and around what seems to
/// move where that was asked for (`report.odds`).
RgbdFrame redacted(const RgbdFrame& frame, const FrameReport& report,
                   const ObjectCatalogue& catalogue);

}  // namespace ydd
