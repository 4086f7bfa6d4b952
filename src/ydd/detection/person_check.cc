// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/person_check.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ydd {

std::string name_in_rules(const std::string& class_name, const ObjectCatalogue& catalogue) {
  constexpr ClassNameLess kLess;
  const auto is_called = [&](std::string_view name) {
    return !kLess(class_name, name) && !kLess(name, class_name);
  };
  const Subcategory subcategory = catalogue.subcategory_of(class_name);
  if (subcategory == Subcategory::person) return is_called("body") ? "body" : "person";
  // A face is too small a part of a head for the rules that reckon in heads.
  const bool is_face = is_called("face") || is_called("human face");
  if (subcategory == Subcategory::head) return is_face ? class_name : "head";
  if (subcategory == Subcategory::hand) return "hand";
  return class_name;
}

DetectionRecording named_by_rules(DetectionRecording recording, const ObjectCatalogue& catalogue) {
  std::vector<RecordedFrame> frames = recording.frames();
  for (RecordedFrame& frame : frames) {
    for (RecordedDetection& d : frame.detections) {
      d.detection.class_name = name_in_rules(d.detection.class_name, catalogue);
    }
  }
  return DetectionRecording(std::move(frames));
}

std::optional<std::string> nobody_warning(const std::vector<std::string>& classes,
                                          const ObjectCatalogue& catalogue,
                                          const std::string& source) {
  constexpr std::size_t kMostNamed = 8;
  std::vector<std::string> unknown;
  for (const std::string& name : classes) {
    const Subcategory subcategory = catalogue.subcategory_of(name);
    if (subcategory == Subcategory::person || subcategory == Subcategory::head ||
        subcategory == Subcategory::hand) {
      return std::nullopt;
    }
    const bool is_new = std::find(unknown.begin(), unknown.end(), name) == unknown.end();
    if (is_new && !name.empty() && !catalogue.knows(name)) unknown.push_back(name);
  }
  if (unknown.empty()) return source + ": none of the classes is a person, head or hand";
  const std::size_t left_out = unknown.size() - std::min(unknown.size(), kMostNamed);
  unknown.resize(unknown.size() - left_out);
  return fmt::format(
      "{}: none of the classes counts as a person; the object catalogue does not know '{}'{}: if "
      "one "
      "of them is a person, add it to the catalogue (--objects) or rename it in the detector file",
      source, fmt::join(unknown, "', '"),
      left_out > 0 ? fmt::format(" and {} more", left_out) : "");
}

std::optional<std::string> nobody_warning(const DetectionRecording& recording,
                                          const ObjectCatalogue& catalogue,
                                          const std::string& source) {
  const std::vector<std::string> classes = recording.class_names();
  const bool all_known = std::all_of(classes.begin(), classes.end(), [&](const std::string& name) {
    return catalogue.knows(name);
  });
  return all_known ? std::nullopt : nobody_warning(classes, catalogue, source);
}

}  // namespace ydd
