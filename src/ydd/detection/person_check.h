// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ydd/detection/object_catalogue.h"
#include "ydd/detection/recorded_detections.h"

namespace ydd {

/// The name by which the rules for people (MergeOptions, carried boxes) know a class: `person`,
/// `head`, `hand` and `body` for what the catalogue takes for one; faces and other classes keep
/// theirs.
std::string name_in_rules(const std::string& class_name, const ObjectCatalogue& catalogue);

/// One line when none of the classes of a detector counts as a person, head or hand: nothing will
/// be kept out of the map on their account. It names the classes that the catalogue does not know,
/// of which one may be a person by another name. `source` starts the line.
std::optional<std::string> nobody_warning(const std::vector<std::string>& classes,
                                          const ObjectCatalogue& catalogue,
                                          const std::string& source);
/// `recording` with its people called as the rules call them.
DetectionRecording named_by_rules(DetectionRecording recording, const ObjectCatalogue& catalogue);

/// The same warning of what was recorded. A scene without people has none: a line only when there
/// are classes that the catalogue does not know.
std::optional<std::string> nobody_warning(const DetectionRecording& recording,
                                          const ObjectCatalogue& catalogue,
                                          const std::string& source);

}  // namespace ydd
