// SPDX-License-Identifier: Apache-2.0
//
// The network that comes with the clone: what it sees on the carried sample, and that it is what a
// run without words about detection uses.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "accuracy.h"
#include "altered_sequence.h"
#include "command_line.h"
#include "ydd/detection/boxes.h"
#include "ydd/detection/recorded_detections.h"

namespace ydd::e2e {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const fs::path kSample = fs::path(YDD_SOURCE_DIR) / "samples/office_crowd";
constexpr const char* kFew = "4";  // frames, where accuracy is not judged

/// `ydd-slam ARGUMENTS...` of someone who says nothing about detectors, not even by YDD_DETECTOR.
Outcome plain(std::vector<std::string> arguments, const fs::path& folder) {
  arguments.insert(arguments.begin(), {"env", "-u", "YDD_DETECTOR", YDD_BINARY});
  return run_program(std::move(arguments), folder);
}

/// Of the objects of class `wanted` in `truth`: the share that overlap by half with one of `seen`.
double recall(const fs::path& truth, const fs::path& seen, const std::string& wanted) {
  const auto exact = DetectionRecording::read(truth).value();
  const auto found = DetectionRecording::read(seen).value();
  const auto is_seen = [&](const RecordedDetection& object, const RecordedFrame& frame) {
    return std::any_of(frame.detections.begin(), frame.detections.end(), [&](const auto& other) {
      return other.detection.class_name == wanted &&
             intersection_over_union(object.detection.box, other.detection.box) > 0.5F;
    });
  };
  int objects = 0;
  int hits = 0;
  for (const RecordedFrame& frame : found.frames()) {
    for (const RecordedDetection& object : exact.find_index(frame.index.value())->detections) {
      // A sliver at the border of the picture is nothing to judge by.
      if (object.detection.class_name != wanted || object.pixels.value_or(0) <= 2000) continue;
      ++objects;
      if (is_seen(object, frame)) ++hits;
    }
  }
  return objects == 0 ? 0 : static_cast<double>(hits) / objects;
}

TEST(DefaultDetector, SeesThePeopleOfTheSample) {
  if (kSanitized) GTEST_SKIP() << "accuracy is not judged with sanitizers";
  const TemporaryFolder folder;
  const Outcome outcome =
      plain({"detect", kSample, "--every", "9", "--out", folder / "boxes.jsonl"}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_GT(recall(kSample / "detections.jsonl", folder / "boxes.jsonl", "person"), 0.8);
  EXPECT_GT(recall(kSample / "detections.jsonl", folder / "boxes.jsonl", "head"), 0.7);
}

TEST(DefaultDetector, IsRunByTheQuickLibrary) {
  const TemporaryFolder folder;
  // OpenCV, which `auto` falls back to, takes several times as long.
  const Outcome outcome = plain({"detect", kSample, "--frames", "1", "--out",
                                 folder / "boxes.jsonl", "--set", "networks.office.backend=onednn"},
                                folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST(DefaultDetector, IsWhatARunUses) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments = {"run", kSample, "--out", folder / "a", "--quiet"};
  if (kSanitized) arguments.insert(arguments.end(), {"--max-frames", kFew});
  const Outcome outcome = plain(arguments, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json summary = json::parse(read_file(folder / "a/summary.json").value());
  EXPECT_EQ(summary.at("variant"), "evidence");
  if (kSanitized) return;
  EXPECT_LT(ate_m(kSample, folder / "a"), 0.02);  // 0.24 when nothing is rejected
}

TEST(DefaultDetector, IsLeftOutWhereNothingIsRejected) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& words : {std::vector<std::string>{"--dynamic", "off"},
                                                {"--dynamic", "full", "--detector", "none"}}) {
    std::vector<std::string> arguments = {
        "run", kSample, "--max-frames", kFew, "--out", folder / words.back(), "--quiet"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const Outcome outcome = plain(arguments, folder.path());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const json summary =
        json::parse(read_file(fs::path(folder / words.back()) / "summary.json").value());
    EXPECT_EQ(summary.at("variant"), "off");
  }
}

TEST(DefaultDetector, DoesNotHoldUpACameraThatIsQuicker) {
  const TemporaryFolder folder;
  const fs::path sequence = folder / "s";  // of a camera that takes a thousand pictures a second
  make_altered(kSample, sequence, [](std::size_t i, SequenceEntry& entry) {
    entry.stamp.ns = 1'700'000'000'000'000'000 + 1'000'000 * static_cast<std::int64_t>(i);
    entry.depth_stamp = entry.stamp;
  });
  struct Case {
    std::vector<std::string> words;
    std::string told, mode;
  };
  const std::vector<Case> cases = {
      {{"--realtime"}, "tracking does not wait for boxes", "mode: asynchronous"},
      {{"--realtime", "--detect", "every-frame"}, "pictures will be dropped", "mode: every-frame"},
      {{}, "this run is slower than the camera", "mode: every-frame"}};
  for (const Case& c : cases) {
    const fs::path out = folder / fmt::format("o{}", c.words.size());
    std::vector<std::string> arguments = {"run", sequence, "--max-frames", "6", "--out", out};
    arguments.insert(arguments.end(), c.words.begin(), c.words.end());
    const Outcome outcome = plain(arguments, folder.path());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(c.told));
    EXPECT_THAT(read_file(out / "config.yaml").value(), HasSubstr(c.mode));
  }
}

TEST(DefaultDetector, SuggestsFramesToCorrectInTheFormOfTheTraining) {
  const TemporaryFolder folder;
  const Outcome outcome =
      plain({"detect", kSample, "--frames", kFew, "--out", folder / "boxes.jsonl", "--suggest",
             folder / "set/room", "--suggestions", "2"},
            folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  int pictures = 0;
  for (const auto& entry : fs::directory_iterator(folder / "set/room")) {
    if (entry.path().extension() != ".jpg") continue;
    ++pictures;
    const json labels = json::parse(read_file(fs::path(entry).replace_extension(".json")).value());
    EXPECT_FALSE(labels.at("boxes").empty());  // people walk about in the sample
    for (const json& box : labels.at("boxes")) {
      ASSERT_EQ(box.size(), 5U);
      EXPECT_TRUE(box[0].is_string());
      EXPECT_LT(box[1], box[3]);
      EXPECT_LT(box[2], box[4]);
    }
    EXPECT_TRUE(labels.at("ignore").is_array());
  }
  EXPECT_EQ(pictures, 2);
}

TEST(DefaultDetector, IsNamedByTheEnvironment) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program({"env", "YDD_DETECTOR=nowhere.yaml", YDD_BINARY, "run",
                                       kSample, "--out", folder / "a", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
  EXPECT_THAT(outcome.error_lines().front(), HasSubstr("nowhere.yaml"));
  EXPECT_THAT(outcome.error_lines().front(), HasSubstr("YDD_DETECTOR"));
  EXPECT_FALSE(fs::exists(folder / "a"));
}

}  // namespace
}  // namespace ydd::e2e
