// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/detector_runner.h"

#include <atomic>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

/// Sees one box whose place tells the frame; fails on frame 3, throws on frame 300.
class Numbering final : public Detector {
 public:
  explicit Numbering(std::atomic<std::thread::id>* where = nullptr) : where_(where) {}
  Result<Detections> detect(const RgbdFrame& frame) override {
    if (where_) where_->store(std::this_thread::get_id());
    if (frame.index == 3) return Error{"frame 3 cannot be judged"};
    if (frame.index == 300) throw std::runtime_error("a layer\nwithout memory");
    const auto x = static_cast<float>(frame.index);
    return Detections{{"person", 0.5F, {x, 0, x + 1, 1}}};
  }

 private:
  std::atomic<std::thread::id>* where_;
};

RgbdFrame frame(std::int64_t index) {
  RgbdFrame out;
  out.index = index;
  out.grey = GreyImage(320, 8, std::vector<std::uint8_t>(std::size_t{320} * 8, 100));
  return out;
}

TEST(DetectorRunner, AnswersEveryFrameInOrder) {
  DetectorRunner runner(std::make_unique<Numbering>());
  for (int i = 10; i < 200; ++i) {
    runner.start(frame(i));
    const DetectorRunner::Answer answer = runner.join();
    ASSERT_TRUE(answer.detections.ok());
    ASSERT_EQ(answer.detections->size(), 1U);
    EXPECT_EQ(answer.detections->front().box.x0, static_cast<float>(i));
    EXPECT_EQ(answer.time.stage, "detect");
  }
}

TEST(DetectorRunner, AFailureBelongsToItsFrameOnly) {
  DetectorRunner runner(std::make_unique<Numbering>());
  for (int i = 2; i < 5; ++i) {
    runner.start(frame(i));
    const auto answer = runner.join();
    EXPECT_EQ(answer.detections.ok(), i != 3);
    if (i == 3) {
      EXPECT_EQ(answer.detections.error().message, "frame 3 cannot be judged");
    }
  }
}

TEST(DetectorRunner, WhatItThrowsIsAnErrorOfItsFrame) {
  DetectorRunner runner(std::make_unique<Numbering>());
  for (int i = 299; i < 302; ++i) {
    runner.start(frame(i));
    const auto answer = runner.join();
    EXPECT_EQ(answer.detections.ok(), i != 300);
    EXPECT_EQ(answer.frame, i);
    if (i == 300) {
      EXPECT_EQ(answer.detections.error().message, "detector: internal: a layer without memory");
    }
  }
}

TEST(DetectorRunner, WorksInAThreadOfItsOwn) {
  std::atomic<std::thread::id> where;
  DetectorRunner runner(std::make_unique<Numbering>(&where));
  runner.start(frame(0));
  ASSERT_TRUE(runner.join().detections.ok());
  EXPECT_NE(where.load(), std::this_thread::get_id());
}

TEST(DetectorRunner, MayBeDroppedAtAnyTime) {
  { const DetectorRunner idle(std::make_unique<Numbering>()); }
  DetectorRunner busy(std::make_unique<Numbering>());
  busy.start(frame(0));
}

/// Boxes whose place tells the frame in which they were seen.
std::vector<float> frames_seen(const DetectOptions& options, int frames) {
  AsynchronousDetection detection(std::make_unique<Numbering>(), options);
  std::vector<float> seen;
  for (int i = 10; i < 10 + frames; ++i) {
    const auto boxes = detection.next(frame(i));
    EXPECT_TRUE(boxes.detections.ok());
    EXPECT_LE(boxes.detections->size(), 1U);
    seen.push_back(boxes.detections->empty() ? -1 : boxes.detections->front().box.x0);
  }
  return seen;
}

DetectOptions asynchronous(int latency_frames) {
  DetectOptions options;
  options.mode = DetectMode::asynchronous;
  options.latency_frames = latency_frames;
  options.carry.motion = BoxMotion::none;
  options.carry.missed = 0;
  return options;
}

TEST(AsynchronousDetection, AFixedLatencyIsKept) {
  EXPECT_EQ(frames_seen(asynchronous(1), 5), (std::vector<float>{10, 10, 11, 12, 13}));
  EXPECT_EQ(frames_seen(asynchronous(3), 8), (std::vector<float>{10, 10, 10, 10, 10, 10, 13, 13}));
}

TEST(AsynchronousDetection, TheFirstFrameHasItsOwnBoxesAndNoneIsNewerThanItsFrame) {
  const std::vector<float> seen = frames_seen(asynchronous(0), 50);
  EXPECT_EQ(seen.front(), 10);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_LE(seen[i], static_cast<float>(10 + i));
    if (i > 0) {
      EXPECT_GE(seen[i], seen[i - 1]);
    }
  }
}

TEST(AsynchronousDetection, AFailureIsReported) {
  AsynchronousDetection detection(std::make_unique<Numbering>(), asynchronous(1));
  EXPECT_TRUE(detection.next(frame(2)).detections.ok());
  EXPECT_TRUE(detection.next(frame(3)).detections.ok()) << "looked at frame 2 again";
  const auto failed = detection.next(frame(4));
  ASSERT_FALSE(failed.detections.ok());
  EXPECT_EQ(failed.detections.error().message, "frame 3 cannot be judged");
}

}  // namespace
}  // namespace ydd
