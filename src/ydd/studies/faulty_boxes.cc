// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/faulty_boxes.h"

#include <algorithm>
#include <cmath>

namespace ydd {
namespace {

constexpr std::string_view kPerson = "person";

void miss_nearest_person(std::vector<RecordedDetection>& detections) {
  const auto area_px2 = [](const RecordedDetection& d) {
    return d.detection.class_name == kPerson ? d.detection.box.area() : 0.0F;
  };
  const auto nearest =
      std::max_element(detections.begin(), detections.end(),
                       [&](const auto& a, const auto& b) { return area_px2(a) < area_px2(b); });
  if (nearest == detections.end() || area_px2(*nearest) <= 0) return;
  const Box box = nearest->detection.box;
  detections.erase(nearest);
  std::erase_if(detections, [&](const RecordedDetection& d) {
    const bool part = d.detection.class_name == "head" || d.detection.class_name == "hand";
    const Box& b = d.detection.box;
    return part && box.contains(0.5F * (b.x0 + b.x1), 0.5F * (b.y0 + b.y1));
  });
}

void add_fault(RecordedFrame& frame, BoxFault fault, double since_start_s) {
  switch (fault) {
    case BoxFault::none:
      return;
    case BoxFault::every_other_second:
      if (std::fmod(since_start_s, 2.0) >= 1.0) frame.detections.clear();
      return;
    case BoxFault::nearest_person:
      return miss_nearest_person(frame.detections);
    case BoxFault::confused:
      for (RecordedDetection& d : frame.detections) {
        if (d.detection.class_name == kPerson) d.detection.class_name = "chair";
      }
      return;
    case BoxFault::blind:
      frame.detections.clear();
      return;
  }
}

}  // namespace

std::string_view to_string(BoxFault fault) {
  switch (fault) {
    case BoxFault::none:
      return "exact";
    case BoxFault::every_other_second:
      return "none every other second";
    case BoxFault::nearest_person:
      return "nearest person missed";
    case BoxFault::confused:
      return "persons called chairs";
    case BoxFault::blind:
      return "none";
  }
  return "";
}

std::vector<RecordedFrame> with_fault(std::vector<RecordedFrame> frames, BoxFault fault) {
  for (RecordedFrame& frame : frames) {
    add_fault(frame, fault, seconds_between(frames.front().stamp, frame.stamp));
  }
  return frames;
}

}  // namespace ydd
