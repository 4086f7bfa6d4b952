// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/faulty_boxes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::ElementsAre;

RecordedDetection box(const char* name, float x0, float y0, float x1, float y1) {
  RecordedDetection d;
  d.detection.class_name = name;
  d.detection.box = {x0, y0, x1, y1};
  return d;
}

/// Two persons, the right one nearer, at 10 frames a second.
std::vector<RecordedFrame> recording(int frames) {
  std::vector<RecordedFrame> out;
  for (int i = 0; i < frames; ++i) {
    RecordedFrame frame;
    frame.stamp.ns = 5'000'000'000 + std::int64_t{100'000'000} * i;
    frame.detections = {box("person", 0, 0, 50, 100), box("head", 10, 0, 30, 20),
                        box("person", 200, 0, 400, 400), box("head", 250, 0, 350, 80),
                        box("cup", 260, 100, 280, 130)};
    out.push_back(frame);
  }
  return out;
}

std::vector<std::string> classes(const RecordedFrame& frame) {
  std::vector<std::string> out;
  for (const RecordedDetection& d : frame.detections) out.push_back(d.detection.class_name);
  return out;
}

TEST(FaultyBoxes, AreGoneEveryOtherSecond) {
  const auto frames = with_fault(recording(40), BoxFault::every_other_second);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].detections.empty(), (i / 10) % 2 == 1) << i;
  }
}

TEST(FaultyBoxes, MissTheNearestPersonWithItsHead) {
  const auto frames = with_fault(recording(2), BoxFault::nearest_person);
  for (const RecordedFrame& frame : frames) {
    EXPECT_THAT(classes(frame), ElementsAre("person", "head", "cup"));
    EXPECT_EQ(frame.detections.front().detection.box.x1, 50);
  }
}

TEST(FaultyBoxes, TakePersonsForChairs) {
  EXPECT_THAT(classes(with_fault(recording(1), BoxFault::confused).front()),
              ElementsAre("chair", "head", "chair", "head", "cup"));
}

TEST(FaultyBoxes, OfNoKindAreTheSame) {
  EXPECT_EQ(classes(with_fault(recording(1), BoxFault::none).front()),
            classes(recording(1).front()));
  EXPECT_TRUE(with_fault(recording(1), BoxFault::blind).front().detections.empty());
  EXPECT_TRUE(with_fault({}, BoxFault::every_other_second).empty());
}

}  // namespace
}  // namespace ydd
