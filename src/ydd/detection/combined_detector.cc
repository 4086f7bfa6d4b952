// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/combined_detector.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "ydd/detection/boxes.h"

namespace ydd {
namespace {

constexpr const char* kPerson = "person";
constexpr const char* kBody = "body";
constexpr const char* kHead = "head";
constexpr const char* kHand = "hand";

std::vector<Box> boxes_of(const Detections& detections, const char* class_name) {
  std::vector<Box> boxes;
  for (const Detection& d : detections) {
    if (d.class_name == class_name) boxes.push_back(d.box);
  }
  return boxes;
}

template <class Predicate>
bool any(const std::vector<Box>& boxes, Predicate predicate) {
  return std::any_of(boxes.begin(), boxes.end(), predicate);
}

float centre_x(const Box& b) { return (b.x0 + b.x1) / 2; }
float centre_y(const Box& b) { return (b.y0 + b.y1) / 2; }

bool is_same_person(const Box& body, const Box& person, const MergeOptions& options) {
  return intersection_over_union(body, person) > static_cast<float>(options.same_person_iou) ||
         coverage(body, person) > static_cast<float>(options.same_person_coverage) ||
         coverage(person, body) > static_cast<float>(options.same_person_coverage);
}

bool is_head_of(const Box& head, const Box& body, const MergeOptions& options) {
  return coverage(head, body) > static_cast<float>(options.head_in_body) &&
         centre_y(head) < centre_y(body);
}

/// Heads whose person was not detected: only they have to vouch for hands themselves.
std::vector<Box> lone_heads(std::vector<Box> heads, const std::vector<Box>& persons,
                            const MergeOptions& options) {
  std::erase_if(heads, [&](const Box& head) {
    return any(persons, [&](const Box& person) {
      return coverage(head, person) > static_cast<float>(options.head_in_body);
    });
  });
  return heads;
}

bool is_hand_near(const Box& hand, const std::vector<Box>& persons, const std::vector<Box>& heads,
                  const MergeOptions& options) {
  return any(persons,
             [&](const Box& person) {
               const float margin = static_cast<float>(options.hand_margin) * person.width();
               return intersection(hand, grown(person, margin)).area() > 0;
             }) ||
         any(heads, [&](const Box& head) {
           const float reach = static_cast<float>(options.hand_reach_heads) * head.height();
           return std::hypot(centre_x(hand) - centre_x(head), centre_y(hand) - centre_y(head)) <=
                  reach;
         });
}

/// Rules 2 to 4.
Detections with_bodies_as_persons(const Detections& detections, const MergeOptions& options) {
  std::vector<Box> persons = boxes_of(detections, kPerson);
  const std::vector<Box> heads = boxes_of(detections, kHead);
  Detections out;
  for (Detection d : detections) {
    if (d.class_name == kBody) {
      const bool known =
          any(persons, [&](const Box& p) { return is_same_person(d.box, p, options); });
      if (known || !any(heads, [&](const Box& h) { return is_head_of(h, d.box, options); })) {
        continue;
      }
      d.class_name = kPerson;
      persons.push_back(d.box);
    }
    out.push_back(std::move(d));
  }
  return out;
}

}  // namespace

void MergeOptions::describe(OptionTable& table) {
  table.add("enabled", enabled, "make one picture of people; else only put the lists together");
  table.add("same_class_iou", same_class_iou, {0, 1}, "",
            "two boxes of a class, from two networks, with more overlap are one thing");
  table.add("same_person_iou", same_person_iou, {0, 1}, "",
            "a body and a person with more overlap (intersection over union) are one person");
  table.add("same_person_coverage", same_person_coverage, {0, 1}, "",
            "so are they when more than this share of one lies in the other");
  table.add("head_in_body", head_in_body, {0, 1}, "",
            "a head belongs to a body when more than this share of it lies in the body's box");
  table.add("hand_reach_heads", hand_reach_heads, {0, 100}, "",
            "a hand is kept within this many head heights of a head without a person");
  table.add("hand_margin", hand_margin, {0, 10}, "",
            "or where it touches a person's box grown by this share of its width");
}

Detections merge_people(Detections detections, const MergeOptions& options) {
  if (!options.enabled) return sorted_by_score(std::move(detections));
  detections = with_bodies_as_persons(
      suppress_non_maxima(std::move(detections), static_cast<float>(options.same_class_iou)),
      options);
  const std::vector<Box> persons = boxes_of(detections, kPerson);
  const std::vector<Box> heads = lone_heads(boxes_of(detections, kHead), persons, options);
  std::erase_if(detections, [&](const Detection& d) {
    return d.class_name == kHand && !is_hand_near(d.box, persons, heads, options);
  });
  return detections;
}

CombinedDetector::CombinedDetector(std::vector<std::unique_ptr<Detector>> detectors,
                                   const MergeOptions& options)
    : detectors_(std::move(detectors)), options_(options) {}

Result<Detections> CombinedDetector::detect(const RgbdFrame& frame) {
  Detections all;
  for (const auto& detector : detectors_) {
    Result<Detections> found = detector->detect(frame);
    if (!found) return found.error();
    std::move(found->begin(), found->end(), std::back_inserter(all));
  }
  return merge_people(std::move(all), options_);
}

std::string CombinedDetector::device() const {
  std::string all;
  for (const auto& detector : detectors_) {
    const std::string one = detector->device();
    if (all.find(one) != std::string::npos) continue;
    all += all.empty() ? one : ", " + one;
  }
  return all;
}

}  // namespace ydd
