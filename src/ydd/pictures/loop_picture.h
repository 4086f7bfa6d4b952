// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/image/image.h"
#include "ydd/map/atlas.h"
#include "ydd/system/mapping_runner.h"

namespace ydd {

/// The place then (left) and now (right), with lines between the map points that both frames see in
/// `atlas`, which is one after the loop was closed. A keyframe that is no longer kept shows its
/// picture alone. The pictures must have one size; empty if they have not.
ColourImage loop_picture(const LoopReport& loop, const Atlas& atlas, const ColourImage& matched,
                         const ColourImage& current);

}  // namespace ydd
