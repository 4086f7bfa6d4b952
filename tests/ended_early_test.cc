// SPDX-License-Identifier: Apache-2.0
//
// Runs that end otherwise than by the end of their sequence: what was done is there, and says so.
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "altered_sequence.h"
#include "small_world.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/map_files/map_file.h"

namespace ydd::e2e {
namespace {

using nlohmann::json;
using testing::AnyOf;
using testing::EndsWith;
using testing::HasSubstr;
using namespace std::chrono_literals;

json summary_of(const fs::path& out) {
  return json::parse(read_file(out / "summary.json").value());
}

std::size_t poses_in(const fs::path& out) {
  const auto poses = read_tum_trajectory(out / "trajectory.tum");
  EXPECT_TRUE(poses.ok()) << poses.error().message;
  return poses ? poses->size() : 0;
}

/// Nothing half written lies about.
void expect_no_leftovers(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    EXPECT_FALSE(name.ends_with(".tmp") || name.ends_with(".new") || name.ends_with("-journal"))
        << entry.path();
  }
}

/// `sh -c SCRIPT`, in which $Y is the binary.
Outcome shell(const std::string& script, const fs::path& folder = ".") {
  return run_program({"sh", "-c", "Y=" YDD_BINARY "; " + script}, folder);
}

/// The frames of `sequence`, half a second apart: played at their pace, they wait for whatever is
/// to happen in between, however slow the machine is.
fs::path played_slowly(const fs::path& sequence, const fs::path& to) {
  make_altered(sequence, to, [](std::size_t i, SequenceEntry& entry) {
    entry.stamp = entry.depth_stamp = {static_cast<std::int64_t>(i + 1) * 500'000'000};
  });
  return to;
}

class EndedBySignal : public testing::TestWithParam<int> {};

TEST_P(EndedBySignal, WritesWhatWasDone) {
  const TemporaryFolder folder;
  std::mt19937 random(static_cast<unsigned>(GetParam()));
  const int wait_ms = std::uniform_int_distribution<int>(300, 1500)(random);
  const fs::path slow = played_slowly(room(), folder / "slow");
  const Outcome outcome = shell(
      fmt::format(
          // A shell's background jobs ignore SIGINT.
          "env --default-signal=INT $Y run {} --realtime --out o --save-map o.map >out 2>err & "
          "while ! grep -q 'map started' err; do sleep 0.05; done; sleep {:.3f}; kill -{} $!; wait "
          "$!",
          slow.string(), wait_ms * 1e-3, GetParam()),
      folder.path());
  EXPECT_EQ(outcome.exit_code, 128 + GetParam());
  const json summary = summary_of(folder / "o");
  EXPECT_EQ(summary.at("complete"), false);
  EXPECT_THAT(std::string(summary.at("incomplete")), HasSubstr("interrupted by SIG"));
  EXPECT_GE(poses_in(folder / "o"), 1U);
  EXPECT_LT(summary.at("frames_in").get<int>(), kFrames);
  EXPECT_TRUE(fs::exists(folder / "o/report.html"));
  const auto map = load_map(folder / "o.map");
  ASSERT_TRUE(map.ok()) << map.error().message;
  EXPECT_GT(map->keyframes().size(), 0U);
  expect_no_leftovers(folder.path());
}

INSTANTIATE_TEST_SUITE_P(Signals, EndedBySignal, testing::Values(SIGINT, SIGTERM, SIGHUP),
                         [](const auto& tried) { return fmt::format("{}", tried.param); });

TEST(EndedEarly, ByAnErrorInTheMiddle) {
  const TemporaryFolder folder;
  const fs::path damaged = copy_of(few_frames(), folder / "damaged");
  std::vector<fs::path> pictures;
  for (const auto& entry : fs::directory_iterator(damaged / "rgb"))
    pictures.push_back(entry.path());
  std::sort(pictures.begin(), pictures.end());
  fs::resize_file(pictures.at(3), 10);
  const Outcome outcome =
      ydd_slam({"run", "damaged", "--strict", "--out", "o", "--quiet"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("frame 3"));
  EXPECT_THAT(outcome.err, HasSubstr("what was done until then is in o"));
  EXPECT_EQ(poses_in(folder / "o"), 3U);
  EXPECT_EQ(summary_of(folder / "o").at("complete"), false);
}

TEST(EndedEarly, ByADetectorThatFailsInTheMiddle) {
  const TemporaryFolder folder;
  std::ifstream all(few_frames() / "detections.jsonl");
  std::ofstream boxes(folder / "boxes.jsonl");
  std::string line;
  for (int i = 0; i < 4 && std::getline(all, line); ++i) boxes << line << "\n";
  boxes.close();
  const Outcome outcome = ydd_slam(
      {"run", few_frames().string(), "--out", "o", "--quiet", "--detections", "boxes.jsonl"},
      folder.path());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("frame 4: "));
  EXPECT_EQ(poses_in(folder / "o"), 4U);
  EXPECT_EQ(summary_of(folder / "o").at("complete"), false);
}

TEST(EndedEarly, PicturesThatCannotBeReadAreToldOnce) {
  const TemporaryFolder folder;
  const fs::path damaged = copy_of(few_frames(), folder / "damaged");
  int left = 4;
  for (const auto& entry : fs::directory_iterator(damaged / "depth")) {
    if (left-- > 0) fs::resize_file(entry.path(), 10);
  }
  const Outcome outcome = ydd_slam({"run", "damaged", "--out", "o", "--quiet"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("3 more frames were skipped for the same reason"));
  EXPECT_EQ(summary_of(folder / "o").at("frames_skipped").size(), 4U);
}

class LongWork : public testing::TestWithParam<const char*> {};

TEST_P(LongWork, EndsSoonAndLeavesNothing) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "t");
  const Outcome outcome = shell(
      fmt::format("export TMPDIR=$PWD/t; env --default-signal=INT $Y {} >out 2>err & "
                  "while [ -z \"$(ls -d t/* made.*.part 2>/dev/null)\" ]; do sleep 0.05; done; "
                  "kill -INT $!; wait $!; result=$?; cat err >&2; exit $result",
                  GetParam()),
      folder.path());
  EXPECT_EQ(outcome.exit_code, 128 + SIGINT);
  EXPECT_THAT(outcome.err, EndsWith("error: SIGINT asked to end; what was not finished is gone\n"));
  EXPECT_TRUE(fs::is_empty(folder / "t"));
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    EXPECT_THAT(entry.path().filename().string(), AnyOf("t", "out", "err"));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Commands, LongWork,
    testing::Values("simulate made --frames 100000 --set width=160 --set height=120 --quiet",
                    "bench days --rooms 1 --width 160 --quiet",
                    "bench ablation " YDD_SOURCE_DIR "/samples/office_crowd --simulated 1"),
    [](const auto& tried) { return fmt::format("{}", tried.index); });

struct Hopeless {
  const char* name;
  const char* camera;  ///< lines that replace the sequence's
  const char* reason;
};

class NothingTracked : public testing::TestWithParam<Hopeless> {};

TEST_P(NothingTracked, IsAFailureWithAReasonAndReplacesNoMap) {
  const TemporaryFolder folder;
  const Outcome good =
      ydd_slam({"run", few_frames().string(), "--out", "a", "--quiet", "--save-map", "a.map"},
               folder.path());
  ASSERT_EQ(good.exit_code, 0) << good.err;
  const std::string map = read_file(folder / "a.map").value();
  const Outcome bad = ydd_slam({"run", few_frames().string(), "--set", GetParam().camera, "--out",
                                "b", "--quiet", "--save-map", "a.map"},
                               folder.path());
  EXPECT_EQ(bad.exit_code, 1);
  ASSERT_EQ(bad.error_lines().size(), 1U) << bad.err;
  EXPECT_THAT(bad.err, HasSubstr(GetParam().reason));
  EXPECT_TRUE(fs::exists(folder / "b/summary.json"));
  EXPECT_EQ(read_file(folder / "a.map").value(), map);
}

INSTANTIATE_TEST_SUITE_P(
    Reasons, NothingTracked,
    testing::Values(Hopeless{"DepthScale", "camera.depth_scale=1", "depth scale 1"},
                    Hopeless{"TooFewPoints", "tracking.min_initial_points=5000", "keypoints"}),
    [](const auto& tried) { return tried.param.name; });

TEST(EndedEarly, AMapThatCannotBeSavedCostsOnlyTheMap) {
  const TemporaryFolder folder;
  const fs::path slow = played_slowly(few_frames(), folder / "slow");
  const Outcome outcome =
      shell(fmt::format("mkdir m; $Y run {} --out o --save-map m/a.map --realtime 2>err & "
                        "while ! grep -q 'map started' err; do sleep 0.05; done; rm -r m; "
                        "wait $!; result=$?; cat err >&2; exit $result",
                        slow.string()),
            folder.path());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("a.map"));
  EXPECT_GT(poses_in(folder / "o"), 0U);
  EXPECT_TRUE(fs::exists(folder / "o/report.html"));
}

TEST(StandardStreams, AFullOneIsAFailure) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  for (const char* const command : {"options", "eval T T --json", "eval T T", "--help"}) {
    std::string text = command;
    const std::string truth = few_frames() / "groundtruth.txt";
    for (std::size_t at = 0; (at = text.find('T')) != std::string::npos;)
      text.replace(at, 1, truth);
    const Outcome outcome = shell("$Y " + text + " > /dev/full");
    EXPECT_EQ(outcome.exit_code, 1) << command;
    EXPECT_EQ(outcome.error_lines().size(), 1U) << command << ": " << outcome.err;
  }
}

TEST(StandardStreams, ClosedOnesDoNotBecomeOtherFiles) {
  const TemporaryFolder folder;
  const Outcome outcome =
      shell(fmt::format("$Y run {} --out o --save-map o.map <&- >&- 2>&-", few_frames().string()),
            folder.path());
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(load_map(folder / "o.map").ok());
}

TEST(Configuration, RepeatsTheRunWithItsFrames) {
  const TemporaryFolder folder;
  const Outcome first = ydd_slam({"run", room().string(), "--out", "a", "--quiet", "--start-frame",
                                  "2", "--max-frames", "5", "--deterministic"},
                                 folder.path());
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const Outcome again =
      ydd_slam({"run", room().string(), "--out", "b", "--quiet", "--config", "a/config.yaml"},
               folder.path());
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(summary_of(folder / "b").at("frames_in"), 5);
  EXPECT_EQ(read_file(folder / "a/trajectory.tum").value(),
            read_file(folder / "b/trajectory.tum").value());
}

}  // namespace
}  // namespace ydd::e2e
