// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/detector_runner.h"

#include <atomic>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

/// Sees one box whose place tells the frame; fails on frame 3.
class Numbering final : public Detector {
 public:
  explicit Numbering(std::atomic<std::thread::id>* where = nullptr) : where_(where) {}
  Result<Detections> detect(const RgbdFrame& frame) override {
    if (where_) where_->store(std::this_thread::get_id());
    if (frame.index == 3) return Error{"frame 3 cannot be judged"};
    const auto x = static_cast<float>(frame.index);
    return Detections{{"person", 0.5F, {x, 0, x + 1, 1}}};
  }

 private:
  std::atomic<std::thread::id>* where_;
};

RgbdFrame frame(std::int64_t index) {
  RgbdFrame out;
  out.index = index;
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

}  // namespace
}  // namespace ydd
