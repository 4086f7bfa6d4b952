// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/detector_runner.h"

#include <stdexcept>
#include <utility>

namespace ydd {

DetectorRunner::DetectorRunner(std::unique_ptr<Detector> detector)
    : detector_(std::move(detector)), thread_([this] {
        while (auto frame = frames_.pop()) {
          StageTimes times;
          Answer answer;
          {
            StageTimer timer(times, "detect");
            answer.detections = detector_->detect(*frame);
          }
          answer.time = times.front();
          answers_.push(std::move(answer));
        }
      }) {}

DetectorRunner::~DetectorRunner() {
  frames_.close();
  answers_.close();
}

void DetectorRunner::start(const RgbdFrame& frame) { frames_.push(frame); }

DetectorRunner::Answer DetectorRunner::join() {
  auto answer = answers_.pop();
  if (!answer) throw std::logic_error("DetectorRunner: join without start");
  return std::move(*answer);
}

}  // namespace ydd
