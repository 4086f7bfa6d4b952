// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/recorded_detections.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::HasSubstr;

RecordedFrame frame_at(std::int64_t ns, Detections detections = {}) {
  RecordedFrame frame;
  frame.stamp = {ns};
  for (Detection& d : detections) frame.detections.push_back({.detection = std::move(d)});
  return frame;
}

RgbdFrame picture_at(std::int64_t ns, int width_px = 64, int height_px = 48) {
  RgbdFrame frame;
  frame.stamp = {ns};
  frame.colour = ColourImage(width_px, height_px,
                             std::vector<Bgr>(static_cast<std::size_t>(width_px) * height_px));
  return frame;
}

class RecordedDetectionsFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              fmt::format("ydd_recorded_{}_{}", ::getpid(),
                          testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& content) const {
    std::ofstream(path(), std::ios::binary) << content;
    return path();
  }
  std::filesystem::path path() const { return folder_ / "detections.jsonl"; }
  std::string error_of(const std::string& content) const {
    const auto result = DetectionRecording::read(write(content));
    return result ? "no error" : result.error().message;
  }

 private:
  std::filesystem::path folder_;
};

constexpr const char* kGood = R"({"timestamp": "1.5", "detections": []})";

TEST_F(RecordedDetectionsFile, ReadsTheFormatOfExactDetections) {
  const auto recording = DetectionRecording::read(write(
      R"({"timestamp": "1700000000.033333", "frame": 1, "file": "rgb/a.png", "weather": {"x": 1}, )"
      R"("detections": [{"cls": "person", "name": "personA", "id": 50, "dynamic": true, )"
      R"("box": [46, 0, 268, 480], "pixels": 72739, "moved_in_sequence": false, "new": [1]}]})"
      "\n"));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  ASSERT_EQ(recording->frames().size(), 1U);
  const RecordedFrame& frame = recording->frames()[0];
  EXPECT_EQ(frame.stamp.ns, 1700000000033333000);
  EXPECT_EQ(frame.index, 1);
  EXPECT_EQ(frame.file, "rgb/a.png");
  ASSERT_EQ(frame.detections.size(), 1U);
  const RecordedDetection& d = frame.detections[0];
  EXPECT_EQ(d.detection.class_name, "person");
  EXPECT_EQ(d.detection.score, 1.0F);
  EXPECT_EQ(d.detection.box, (Box{46, 0, 268, 480}));
  EXPECT_EQ(d.name, "personA");
  EXPECT_EQ(d.id, 50);
  EXPECT_EQ(d.dynamic, true);
  EXPECT_EQ(d.moved_in_sequence, false);
  EXPECT_EQ(d.pixels, 72739);
}

TEST_F(RecordedDetectionsFile, WrittenFramesReadBackBitByBit) {
  RecordedFrame full = frame_at(
      1700000000123456789, {{"a \"quoted\" Ünit\n", 0.1F, {1.0F / 3.0F, 1e-7F, 639.9999F, 7}}});
  full.index = 12;
  full.file = "rgb/1.png";
  full.detections[0].name = "cup3";
  full.detections[0].id = 7;
  full.detections[0].dynamic = false;
  full.detections[0].moved_in_sequence = true;
  full.detections[0].pixels = 99;
  full.detections[0].detection.sure = false;
  const RecordedFrame bare = frame_at(5, {{"head", 0.30000001F, {0, 0, 1, 1}}});
  ASSERT_TRUE(write_recorded_detections(path(), std::vector{full, bare}).ok());
  const auto recording = DetectionRecording::read(path());
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  const RecordedFrame* back = recording->find({1700000000123456789}, 0.0);
  ASSERT_NE(back, nullptr);
  const RecordedDetection& d = back->detections.at(0);
  EXPECT_EQ(d.detection.class_name, full.detections[0].detection.class_name);
  EXPECT_EQ(d.detection.score, 0.1F);
  EXPECT_FALSE(d.detection.sure);
  EXPECT_EQ(d.detection.box, full.detections[0].detection.box);
  EXPECT_EQ(d.name, "cup3");
  EXPECT_EQ(d.id, 7);
  EXPECT_EQ(d.dynamic, false);
  EXPECT_EQ(d.moved_in_sequence, true);
  EXPECT_EQ(d.pixels, 99);
  EXPECT_EQ(back->index, 12);
  EXPECT_EQ(back->file, "rgb/1.png");
  const RecordedDetection& plain = recording->frames().at(0).detections.at(0);
  EXPECT_EQ(plain.detection.score, 0.30000001F);
  EXPECT_TRUE(plain.detection.sure);
  EXPECT_FALSE(plain.id || plain.dynamic || plain.moved_in_sequence || plain.pixels);
}

TEST_F(RecordedDetectionsFile, ErrorsNameFileAndLine) {
  const std::string good = std::string(kGood) + "\n";
  const auto in_line_2 = [&](const std::string& line) {
    std::string message = error_of(good + line);
    EXPECT_THAT(message, HasSubstr("detections.jsonl:2: "));
    EXPECT_EQ(message.find('\n'), std::string::npos);
    return message;
  };
  EXPECT_THAT(in_line_2(R"({"timestamp": "2", "detec)"), HasSubstr("not valid JSON at character"));
  EXPECT_THAT(in_line_2("[]"), HasSubstr("one JSON object"));
  EXPECT_THAT(in_line_2(R"({"detections": []})"), HasSubstr("'timestamp' is missing"));
  EXPECT_THAT(in_line_2(R"({"timestamp": "x", "detections": []})"), HasSubstr("must be seconds"));
  EXPECT_THAT(in_line_2(R"({"timestamp": "2"})"), HasSubstr("'detections' is missing"));
  EXPECT_THAT(in_line_2(R"({"timestamp": "2", "detections": {}})"), HasSubstr("must be a list"));
  EXPECT_THAT(in_line_2(R"({"timestamp": "2", "detections": [3]})"), HasSubstr("hold objects"));
  const auto in_detection = [&](const std::string& members) {
    return in_line_2(R"({"timestamp": "2", "detections": [{)" + members + "}]}");
  };
  EXPECT_THAT(in_detection(R"("box": [0, 0, 1, 1])"), HasSubstr("'cls' is missing"));
  EXPECT_THAT(in_detection(R"("cls": 7, "box": [0, 0, 1, 1])"), HasSubstr("must be string"));
  EXPECT_THAT(in_detection(R"("cls": "cup", "box": [0, 0, 1])"), HasSubstr("four numbers"));
  EXPECT_THAT(in_detection(R"("cls": "cup", "box": [5, 0, 1, 1])"), HasSubstr("x0 <= x1"));
  EXPECT_THAT(in_detection(R"("cls": "cup", "box": [0, 0, 1, 1], "score": 1.5)"),
              HasSubstr("'score' is 1.5"));
  EXPECT_THAT(in_line_2(kGood), HasSubstr("was recorded in line 1"));
}

TEST_F(RecordedDetectionsFile, BoxesThatAreFractionsOfThePictureAreRefused) {
  const auto line = [](int second, const std::string& box) {
    return fmt::format(R"({{"timestamp": "{}", "detections": [{{"cls": "cup", "box": {}}}]}})",
                       second, box) +
           "\n";
  };
  const std::string fractions = line(1, "[0, 0, 1, 1]") + line(2, "[0.1, 0.25, 0.5, 1.0]");
  EXPECT_THAT(error_of(fractions), HasSubstr("as [0.1, 0.25, 0.5, 1]: fractions of the picture"));
  // One box in pixels tells that all are, and whole numbers may be.
  EXPECT_EQ(error_of(fractions + line(3, "[0, 0, 30, 40]")), "no error");
  EXPECT_EQ(error_of(line(1, "[0, 0, 1, 1]")), "no error");
  EXPECT_EQ(error_of(std::string(kGood)), "no error");
}

TEST_F(RecordedDetectionsFile, LinesOfOthersCannotBringItDown) {
  const std::string deep(1'000'000, '[');
  EXPECT_THAT(error_of(deep), HasSubstr("detections.jsonl:1: JSON nested in more than 64 levels"));
  EXPECT_THAT(error_of(R"({"timestamp": "1", "detections": [], "x": )" + deep),
              HasSubstr("nested"));
  EXPECT_THAT(error_of(R"({"timestamp": "1", "frame": 1e300, "detections": []})"),
              HasSubstr("'frame' must be a whole number"));
  for (const char* const number : {"1e39", "-1e6", "1e300"}) {
    EXPECT_THAT(error_of(R"({"timestamp": "1", "detections": [{"cls": "a", "box": [0, 0, 1, )" +
                         std::string(number) + "]}]}"),
                HasSubstr("detections.jsonl:1: 'box' holds"));
  }
}

TEST_F(RecordedDetectionsFile, AMissingOrEmptyFileIsAnError) {
  const auto missing = DetectionRecording::read(path());
  ASSERT_FALSE(missing.ok());
  EXPECT_THAT(missing.error().message, HasSubstr("detections.jsonl"));
  EXPECT_THAT(error_of("\n\n"), HasSubstr("holds no frames"));
}

TEST_F(RecordedDetectionsFile, ReadsEveryLineOfTheRenderedSequence) {
  const char* data = std::getenv("YDD_DATA");
  const auto file = std::filesystem::path(data ? data : "") / "crowd_xyz/detections_gt.jsonl";
  if (data == nullptr || !std::filesystem::exists(file)) {
    GTEST_SKIP() << "set YDD_DATA to the folder that holds crowd_xyz";
  }
  const auto recording = DetectionRecording::read(file);
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ(recording->frames().size(), 300U);
  ASSERT_NE(recording->find_index(299), nullptr);
}

TEST(DetectionRecording, FindsTheNearestFrameWithinTheTolerance) {
  const DetectionRecording recording({frame_at(2'000'000), frame_at(1'000'000)});
  EXPECT_EQ(recording.frames()[0].stamp.ns, 1'000'000) << "in the order of time";
  EXPECT_EQ(recording.find({1'000'000}, 0.0)->stamp.ns, 1'000'000);
  EXPECT_EQ(recording.find({1'400'000}, 0.0005)->stamp.ns, 1'000'000);
  EXPECT_EQ(recording.find({1'600'000}, 0.0005)->stamp.ns, 2'000'000);
  EXPECT_EQ(recording.find({1'500'000}, 0.001)->stamp.ns, 1'000'000) << "a tie goes to the earlier";
  EXPECT_EQ(recording.find({400'000}, 0.0005), nullptr);
  EXPECT_EQ(recording.find({2'600'000}, 0.0005), nullptr);
  EXPECT_EQ(recording.find({2'400'000}, 0.0005)->stamp.ns, 2'000'000);
}

TEST(DetectionRecording, RefusesTwoFramesOfOneTime) {
  EXPECT_THROW(DetectionRecording({frame_at(1), frame_at(1)}), std::logic_error);
}

TEST(RecordedDetector, GivesBoxesInsideTheFrameByFallingScore) {
  RecordedDetector detector(DetectionRecording({frame_at(1, {{"cup", 0.2F, {-5, -5, 10, 10}},
                                                             {"head", 0.9F, {60, 40, 70, 60}},
                                                             {"hand", 0.5F, {64, 0, 80, 48}}})}),
                            "detections.jsonl");
  const auto found = detector.detect(picture_at(1, 64, 48));
  ASSERT_TRUE(found.ok());
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ((*found)[0].class_name, "head");
  EXPECT_EQ((*found)[0].box, (Box{60, 40, 64, 48}));
  EXPECT_EQ((*found)[1].box, (Box{0, 0, 10, 10}));
}

TEST(RecordedDetector, BoxesOfLargerPicturesAreAnError) {
  for (const Box& box : {Box{0, 0, 97, 48}, Box{-33, 0, 9, 9}, Box{0, 0, 9, 73}}) {
    RecordedDetector detector(DetectionRecording({frame_at(1, {{"cup", 0.2F, box}})}), "d.jsonl");
    const auto found = detector.detect(picture_at(1, 64, 48));
    ASSERT_FALSE(found.ok());
    EXPECT_THAT(found.error().message, HasSubstr("reaches far beyond the picture of 64 x 48"));
  }
}

TEST(RecordedDetector, AFrameThatWasNotRecordedIsAnErrorUnlessAllowed) {
  const DetectionRecording recording({frame_at(1'000'000'000)});
  RecordedDetector strict(recording, "detections.jsonl");
  const auto missing = strict.detect(picture_at(3'500'000'000));
  ASSERT_FALSE(missing.ok());
  EXPECT_THAT(missing.error().message, HasSubstr("detections.jsonl: no detections for frame 0"));
  EXPECT_THAT(missing.error().message, HasSubstr("3.500000000"));
  RecordedDetector lenient(recording, "detections.jsonl", {.missing_is_empty = true});
  EXPECT_TRUE(lenient.detect(picture_at(3'500'000'000))->empty());
}

}  // namespace
}  // namespace ydd
