// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "ydd/detection/recorded_detections.h"

namespace ydd {

/// How a detector fails: what is done to boxes that are right.
enum class BoxFault { none, every_other_second, nearest_person, confused, blind };
inline constexpr BoxFault kBoxFaults[] = {BoxFault::none, BoxFault::every_other_second,
                                          BoxFault::nearest_person, BoxFault::confused,
                                          BoxFault::blind};

/// "exact", "none every other second", "nearest person missed", "persons called chairs", "none".
std::string_view to_string(BoxFault fault);

/// The recording with the fault. `every_other_second`: the second, fourth, ... second of the
/// recording has no boxes. `nearest_person`: in each frame the person with the largest box is
/// missing, with the heads and hands whose middle lies in it. `confused`: persons are called
/// chairs. `blind`: no frame has boxes.
std::vector<RecordedFrame> with_fault(std::vector<RecordedFrame> frames, BoxFault fault);

}  // namespace ydd
