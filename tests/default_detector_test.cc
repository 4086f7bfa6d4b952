// SPDX-License-Identifier: Apache-2.0
//
// The network that comes with the clone: what it sees on the carried sample, and that it is what a
// run without words about detection uses.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command_line.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/evaluation/ate.h"

namespace ydd::e2e {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const fs::path kSample = fs::path(YDD_SOURCE_DIR) / "samples/office_crowd";
constexpr const char* kFew = "4";  // frames, where accuracy is not judged

/// `ydd-slam ARGUMENTS...` of someone who says nothing about detectors, not even by YDD_DETECTOR.
Outcome plain(std::vector<std::string> arguments, const fs::path& folder) {
  arguments.insert(arguments.begin(), {"env", "-u", "YDD_DETECTOR", YDD_BINARY});
  return run_programme(std::move(arguments), folder);
}

/// The boxes of the class `wanted` in every frame.
std::map<int, std::vector<std::array<double, 4>>> boxes_of(const fs::path& file,
                                                           const std::string& wanted) {
  std::map<int, std::vector<std::array<double, 4>>> boxes;
  std::istringstream lines(read_file(file).value());
  for (std::string line; std::getline(lines, line);) {
    const json frame = json::parse(line);
    auto& list = boxes[frame.at("frame").get<int>()];
    for (const json& seen : frame.at("detections")) {
      // A sliver at the border of the picture is nothing to judge by.
      if (seen.at("cls") == wanted && seen.value("pixels", 10'000) > 2'000) {
        list.push_back(seen.at("box"));
      }
    }
  }
  return boxes;
}

double iou(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  const double w = std::min(a[2], b[2]) - std::max(a[0], b[0]);
  const double h = std::min(a[3], b[3]) - std::max(a[1], b[1]);
  if (w <= 0 || h <= 0) return 0;
  const auto area = [](const auto& box) { return (box[2] - box[0]) * (box[3] - box[1]); };
  return w * h / (area(a) + area(b) - w * h);
}

/// Share of the boxes of `truth` that overlap one of `seen` by half.
double recall(const fs::path& truth, const fs::path& seen, const std::string& wanted) {
  const auto boxes = boxes_of(seen, wanted);
  int all = 0;
  int found = 0;
  for (const auto& [frame, expected] : boxes_of(truth, wanted)) {
    if (!boxes.contains(frame)) continue;
    for (const auto& box : expected) {
      const auto& near = boxes.at(frame);
      ++all;
      found +=
          std::any_of(near.begin(), near.end(), [&](const auto& b) { return iou(box, b) > 0.5; });
    }
  }
  return all == 0 ? 0 : static_cast<double>(found) / all;
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
  EXPECT_EQ(summary.at("variant"), "full");
  if (kSanitized) return;
  const auto truth = read_tum_trajectory(kSample / "groundtruth.txt");
  const auto estimate = read_tum_trajectory(folder / "a/trajectory.tum");
  ASSERT_TRUE(truth && estimate);
  const auto ate = absolute_trajectory_error(*truth, *estimate);
  ASSERT_TRUE(ate);
  EXPECT_LT(ate->statistics_m.rmse, 0.02);  // 0.24 when nothing is rejected
}

TEST(DefaultDetector, IsLeftOutWhereNothingIsRejected) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--dynamic", "off"}, {"--detector", "none"}}) {
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

TEST(DefaultDetector, IsNamedByTheEnvironment) {
  const TemporaryFolder folder;
  const Outcome outcome = run_programme({"env", "YDD_DETECTOR=nowhere.yaml", YDD_BINARY, "run",
                                         kSample, "--out", folder / "a", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
  EXPECT_THAT(outcome.error_lines().front(), HasSubstr("nowhere.yaml"));
  EXPECT_FALSE(fs::exists(folder / "a"));
}

}  // namespace
}  // namespace ydd::e2e
