// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "ydd/base/options.h"
#include "ydd/detection/detector.h"

namespace ydd {

/// How detections of the classes `person`, `body`, `head` and `hand` from several networks become
/// one picture of people.
struct MergeOptions {
  bool enabled = true;
  double same_class_iou = 0.5;
  double same_person_iou = 0.4;
  double same_person_coverage = 0.7;
  double head_in_body = 0.5;
  double hand_reach_heads = 4.0;
  double hand_margin = 0.1;
  void describe(OptionTable& table);
};

/// Makes one list of people out of everything that several networks saw. By falling score; no
/// `body` is left:
///  1. same class, overlap above `same_class_iou`: the better one stays;
///  2. a body that overlaps a person is that person and goes;
///  3. else a body with a head in its upper half becomes a person, with its own score;
///  4. else it goes: networks see bodies in coats and chairs;
///  5. a hand goes unless it lies at a person, or within reach of a head without a person.
/// Other classes pass. Disabled: only sorted.
Detections merge_people(Detections detections, const MergeOptions& options);

/// Several detectors as one, run one after the other.
class CombinedDetector : public Detector {
 public:
  CombinedDetector(std::vector<std::unique_ptr<Detector>> detectors, const MergeOptions& options);
  Result<Detections> detect(const RgbdFrame& frame) override;
  std::string device() const override;  ///< each of them once

 private:
  std::vector<std::unique_ptr<Detector>> detectors_;
  MergeOptions options_;
};

}  // namespace ydd
