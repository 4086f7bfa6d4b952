// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <thread>

#include "ydd/base/channel.h"
#include "ydd/base/timing.h"
#include "ydd/detection/detector.h"

namespace ydd {

/// A detector in a thread of its own, so that it works beside feature extraction. Every frame given
/// to `start` is answered by one `join`, in order: results belong to their frame.
class DetectorRunner {
 public:
  struct Answer {
    Result<Detections> detections = Detections{};
    StageTime time;
  };

  explicit DetectorRunner(std::unique_ptr<Detector> detector);
  ~DetectorRunner();
  DetectorRunner(const DetectorRunner&) = delete;
  DetectorRunner& operator=(const DetectorRunner&) = delete;

  void start(const RgbdFrame& frame);
  Answer join();

 private:
  std::unique_ptr<Detector> detector_;  // used by thread_ only
  Channel<RgbdFrame> frames_{1};
  Channel<Answer> answers_{1};
  std::jthread thread_;
};

}  // namespace ydd
