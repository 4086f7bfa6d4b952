// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/detector_runner.h"

#include <optional>
#include <utility>

namespace ydd {

DetectorRunner::DetectorRunner(std::unique_ptr<Detector> detector)
    : detector_(std::move(detector)), thread_([this] { run(); }) {}

DetectorRunner::~DetectorRunner() {
  frames_.close();
  answers_.close();
}

void DetectorRunner::run() noexcept {
  const Result<void> ended = guarded("detector", [&]() -> Result<void> {
    while (auto frame = frames_.pop()) answers_.push(answer(*frame));
    return {};
  });
  if (!ended) failure_.set(ended.error());
  frames_.close();  // nobody waits for a thread that has ended
  answers_.close();
}

DetectorRunner::Answer DetectorRunner::answer(const RgbdFrame& frame) {
  StageTimes times;
  Answer answer;
  answer.frame = frame.index;
  {
    StageTimer timer(times, "detect");
    answer.detections = guarded("detector", [&] { return detector_->detect(frame); });
  }
  if (!times.empty()) answer.time = times.front();
  return answer;
}

void DetectorRunner::start(const RgbdFrame& frame) { frames_.push(frame); }

DetectorRunner::Answer DetectorRunner::join() {
  auto answer = answers_.pop();
  return answer ? std::move(*answer) : failed();
}

std::optional<DetectorRunner::Answer> DetectorRunner::poll() {
  auto answer = answers_.try_pop();
  if (!answer && failure_) return failed();
  return answer;
}

DetectorRunner::Answer DetectorRunner::failed() const {
  Answer answer;
  answer.detections = failure_.get().error();
  return answer;
}

void DetectOptions::describe(OptionTable& table) {
  table.add(
      "mode", mode,
      "asynchronous: tracking never waits; boxes are carried on from the newest frame that the "
      "detector has seen; auto: every-frame, except in real time when looking is slower than the "
      "camera");
  table.add("latency_frames", latency_frames, {0, 30}, "",
            "asynchronous: use answers just so many frames later; 0: as soon as they are there "
            "(deterministic runs: 2)");
  table.group("carry", carry);
}

AsynchronousDetection::AsynchronousDetection(std::unique_ptr<Detector> detector,
                                             const DetectOptions& options,
                                             const ObjectCatalogue& catalogue)
    : options_(options),
      catalogue_(catalogue),
      runner_(std::move(detector)),
      carrier_(options.carry, catalogue) {}

AsynchronousDetection::Boxes AsynchronousDetection::next(const RgbdFrame& frame) {
  Boxes boxes;
  std::optional<StageTimer> carry(std::in_place, boxes.times, "carry_boxes");
  carrier_.advance(frame);
  carry.reset();
  if (first_) {
    runner_.start(frame);
    asked_ = frame.index;
  }
  std::optional<StageTimer> wait(std::in_place, boxes.times, "wait_for_detector");
  const std::optional<DetectorRunner::Answer> answer = answer_for(frame.index);
  wait.reset();
  first_ = false;
  if (answer) {
    boxes.times.push_back(answer->time);
    if (!answer->detections) {
      boxes.detections = answer->detections.error();
      return boxes;
    }
    const StageTimer take(boxes.times, "take_boxes");
    carrier_.take(answer->frame, *answer->detections);
  }
  if (asked_ < 0) {
    runner_.start(frame);
    asked_ = frame.index;
  }
  boxes.detections = carrier_.now();
  return boxes;
}

void AsynchronousDetection::forget() {
  if (asked_ >= 0) runner_.join();  // an answer for a frame that is no more
  asked_ = -1;
  first_ = true;
  carrier_ = BoxCarrier(options_.carry, catalogue_);
}

std::optional<DetectorRunner::Answer> AsynchronousDetection::answer_for(std::int64_t frame) {
  if (asked_ < 0) return {};
  std::optional<DetectorRunner::Answer> answer;
  if (first_ || (options_.latency_frames > 0 && frame - asked_ >= options_.latency_frames)) {
    answer = runner_.join();
  } else if (options_.latency_frames == 0) {
    answer = runner_.poll();
  }
  if (answer) asked_ = -1;
  return answer;
}

}  // namespace ydd
