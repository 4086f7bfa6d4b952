// SPDX-License-Identifier: Apache-2.0
//
// Whole runs through the binary: simulated sequence in, files out. Small enough for sanitizers.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "accuracy.h"
#include "small_world.h"

namespace ydd::e2e {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::string text_of(const fs::path& file) { return read_file(file).value(); }
json json_of(const fs::path& file) { return json::parse(text_of(file)); }

/// `ydd-slam run SEQUENCE --out OUT ...`, which must succeed.
void run(const fs::path& sequence, const fs::path& out, std::vector<std::string> options) {
  options.insert(options.begin(), {"run", sequence.string(), "--out", out.string(), "--quiet"});
  const Outcome outcome = ydd_slam(options);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
}

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

TEST(Run, FollowsTheCameraThroughAnEmptyRoom) {
  const TemporaryFolder folder;
  run(room(), folder / "a", {"--deterministic"});
  EXPECT_EQ(json_of(folder / "a/summary.json").at("frames_tracked"), kFrames);
  const double error_m = ate_m(room(), folder / "a");
  RecordProperty("ate_mm", static_cast<int>(1000 * error_m));
  EXPECT_LT(error_m, 0.012);
  // `eval` tells the same figure.
  const Outcome eval = ydd_slam(
      {"eval", room() / "groundtruth.txt", (folder / "a/trajectory.tum").string(), "--json"});
  ASSERT_EQ(eval.exit_code, 0) << eval.err;
  EXPECT_NEAR(json::parse(eval.out).at("ate").at("absolute_translational_error").at("rmse"),
              error_m, 1e-9);
}

TEST(Run, AlsoWithMappingInAThreadOfItsOwn) {
  const TemporaryFolder folder;
  run(room(), folder / "a", {});
  EXPECT_EQ(json_of(folder / "a/summary.json").at("frames_tracked"), kFrames);
  EXPECT_LT(ate_m(room(), folder / "a"), 0.02);
}

TEST(Run, RejectingWhatMovesSavesABusyRoom) {
  const TemporaryFolder folder;
  const std::string boxes = busy_room() / "detections.jsonl";
  run(busy_room(), folder / "full",
      {"--deterministic", "--detections", boxes, "--dynamic", "full"});
  const json summary = json_of(folder / "full/summary.json");
  EXPECT_EQ(summary.at("variant"), "full");
  EXPECT_GT(summary.at("features_rejected_by_rule").at("body_depth"), 10 * kFrames);
  if (kSanitized) GTEST_SKIP() << "too few frames to judge accuracy";
  EXPECT_EQ(summary.at("frames_tracked"), kFrames);
  EXPECT_LT(ate_m(busy_room(), folder / "full"), 0.04);
  run(busy_room(), folder / "off", {"--deterministic", "--detections", boxes, "--dynamic", "off"});
  // It does not get lost, it goes along with the people.
  EXPECT_GT(json_of(folder / "off/summary.json").at("frames_tracked"), kFrames / 2);
  EXPECT_GT(ate_m(busy_room(), folder / "off"), 0.1);
}

TEST(Run, TwoDeterministicRunsGiveTheSameBytes) {
  const TemporaryFolder folder;
  for (const char* const out : {"a", "b"}) {
    run(busy_room(), folder / out,
        {"--deterministic", "--dump-map", "--detections", busy_room() / "detections.jsonl",
         "--dynamic", "full", "--max-frames", "40"});
  }
  for (const char* const name : {"trajectory.tum", "keyframes.tum", "map.txt", "config.yaml"}) {
    const std::string a = text_of(folder / "a" / name);
    EXPECT_GT(a.size(), 100U) << name;
    EXPECT_TRUE(a == text_of(folder / "b" / name)) << name << " differs";
  }
}

TEST(Run, LeavesAFolderThatTellsEverything) {
  const TemporaryFolder folder;
  run(few_frames(), folder / "a", {"--deterministic", "--seed", "5"});
  EXPECT_THAT(names_in(folder / "a"),
              testing::UnorderedElementsAre("trajectory.tum", "keyframes.tum", "summary.json",
                                            "config.yaml", "timings.json", "frames.json",
                                            "tracks.jsonl", "report.html"));
  const json summary = json_of(folder / "a/summary.json");
  for (const char* const key : {"version",
                                "sequence",
                                "variant",
                                "detector",
                                "deterministic",
                                "realtime",
                                "seed",
                                "frames_in",
                                "frames_processed",
                                "frames_dropped",
                                "frames_skipped",
                                "frames_tracked",
                                "lost_spans",
                                "keyframes_inserted",
                                "keyframes_kept",
                                "map_points",
                                "features_requested",
                                "features_kept",
                                "features_rejected_by_rule",
                                "wall_seconds",
                                "frames_per_second",
                                "peak_resident_mb",
                                "stage_median_cpu_ms"}) {
    EXPECT_TRUE(summary.contains(key)) << key;
  }
  EXPECT_EQ(summary.at("seed"), 5);
  EXPECT_EQ(summary.at("frames_processed"), 6);
  EXPECT_EQ(read_tum_trajectory(folder / "a/trajectory.tum").value().size(), 6U);
  EXPECT_EQ(read_tum_trajectory(folder / "a/keyframes.tum").value().size(),
            summary.at("keyframes_kept"));
  EXPECT_TRUE(json_of(folder / "a/timings.json").at("per_frame").contains("total"));
  EXPECT_THAT(text_of(folder / "a/config.yaml"), HasSubstr("seed: 5"));
}

TEST(Run, WithoutANameTheFolderIsDatedAndTheLatest) {
  const TemporaryFolder folder;
  const Outcome outcome = ydd_slam({"run", few_frames()}, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("tracked 6 of 6 frames"));
  ASSERT_TRUE(fs::is_symlink(folder / "runs/latest"));
  EXPECT_TRUE(fs::exists(folder / "runs/latest/trajectory.tum"));
  EXPECT_THAT(fs::read_symlink(folder / "runs/latest").string(), testing::StartsWith("few-"));
}

TEST(Run, ItsConfigurationCanBeFedBack) {
  const TemporaryFolder folder;
  const fs::path camera = folder / "mine.yaml";
  std::string text = text_of(few_frames() / "camera.yaml");
  const std::string simulated = "baseline: 0.15";
  ASSERT_NE(text.find(simulated), std::string::npos);
  std::ofstream(camera) << text.replace(text.find(simulated), simulated.size(), "baseline: 0.12");
  run(few_frames(), folder / "a",
      {"--deterministic", "--camera", camera, "--set", "orb.levels=6", "--set",
       "tracking.motion_radius_px=20", "--dynamic", "box"});
  run(few_frames(), folder / "b", {"--config", folder / "a/config.yaml"});
  EXPECT_EQ(text_of(folder / "a/config.yaml"), text_of(folder / "b/config.yaml"));
  EXPECT_EQ(text_of(folder / "a/trajectory.tum"), text_of(folder / "b/trajectory.tum"));
  EXPECT_THAT(text_of(folder / "b/config.yaml"), HasSubstr("baseline: 0.12"));
  // The command line beats the file, for the camera as for everything else.
  run(few_frames(), folder / "c",
      {"--config", folder / "a/config.yaml", "--camera", few_frames() / "camera.yaml", "--set",
       "orb.levels=7"});
  EXPECT_THAT(text_of(folder / "c/config.yaml"), HasSubstr("baseline: 0.15"));
  EXPECT_THAT(text_of(folder / "c/config.yaml"), HasSubstr("levels: 7"));
}

TEST(Run, ThePrintedOptionsAreAConfiguration) {
  const TemporaryFolder folder;
  const Outcome options = ydd_slam({"options"});
  ASSERT_EQ(options.exit_code, 0);
  std::ofstream(folder / "all.yaml") << options.out;
  run(few_frames(), folder / "a", {"--deterministic"});
  run(few_frames(), folder / "b", {"--config", folder / "all.yaml", "--deterministic"});
  EXPECT_EQ(text_of(folder / "a/config.yaml"), text_of(folder / "b/config.yaml"));
}

/// A copy of the few frames whose fourth colour image is cut short.
fs::path with_corrupt_frame(const TemporaryFolder& folder) {
  fs::path copy = copy_of(few_frames(), folder / "damaged");
  std::vector<fs::path> pictures;
  for (const auto& entry : fs::directory_iterator(copy / "rgb")) pictures.push_back(entry.path());
  std::sort(pictures.begin(), pictures.end());
  fs::resize_file(pictures.at(3), fs::file_size(pictures.at(3)) / 2);
  return copy;
}

TEST(Run, ACorruptFrameIsSkippedAndCounted) {
  const TemporaryFolder folder;
  run(with_corrupt_frame(folder), folder / "a", {});
  const json summary = json_of(folder / "a/summary.json");
  EXPECT_EQ(summary.at("frames_in"), 6);
  EXPECT_EQ(summary.at("frames_processed"), 5);
  EXPECT_EQ(summary.at("frames_tracked"), 5);
  ASSERT_EQ(summary.at("frames_skipped").size(), 1U);
  EXPECT_EQ(summary.at("frames_skipped").at(0).at("frame"), 3);
  EXPECT_THAT(summary.at("frames_skipped").at(0).at("reason"), HasSubstr(".png"));
  EXPECT_EQ(read_tum_trajectory(folder / "a/trajectory.tum").value().size(), 5U);
}

TEST(Run, ACorruptFrameIsFatalWhenStrict) {
  const TemporaryFolder folder;
  const Outcome outcome =
      ydd_slam({"run", with_corrupt_frame(folder), "--out", folder / "a", "--quiet", "--strict"});
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
  EXPECT_THAT(outcome.error_lines().front(), HasSubstr("frame 3: "));
  EXPECT_EQ(read_tum_trajectory(folder / "a/trajectory.tum").value().size(), 3U);
  EXPECT_EQ(json_of(folder / "a/summary.json").at("complete"), false);
}

TEST(Run, AFrameThatTheRecordingLacksEndsTheRun) {
  const TemporaryFolder folder;
  std::ifstream all(few_frames() / "detections.jsonl");
  std::ofstream some(folder / "some.jsonl");
  std::string line;
  for (int i = 0; std::getline(all, line); ++i) {
    if (i != 4) some << line << "\n";
  }
  some.close();
  const Outcome outcome = ydd_slam({"run", few_frames(), "--out", folder / "a", "--detections",
                                    folder / "some.jsonl", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
  EXPECT_THAT(outcome.error_lines().front(), HasSubstr("some.jsonl"));
  EXPECT_EQ(read_tum_trajectory(folder / "a/trajectory.tum").value().size(), 4U);
}

TEST(Run, WritesPicturesAndOtherFormatsWhenAsked) {
  const TemporaryFolder folder;
  const Outcome outcome =
      ydd_slam({"run", few_frames(), "--out", folder / "a", "--frames", folder / "seen", "--quiet",
                "--detections", few_frames() / "detections.jsonl", "--trajectory-format", "kitti",
                "--json", "--max-frames", "4"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(json::parse(outcome.out), json_of(folder / "a/summary.json"));
  EXPECT_THAT(names_in(folder / "seen"), testing::UnorderedElementsAre("000000.png", "000001.png",
                                                                       "000002.png", "000003.png"));
  const std::string kitti = text_of(folder / "a/trajectory.kitti.txt");
  EXPECT_EQ(std::count(kitti.begin(), kitti.end(), '\n'), 4);
}

TEST(Run, QuietMeansNoWordAndJsonMeansJsonAlone) {
  const TemporaryFolder folder;
  const Outcome quiet = ydd_slam({"run", few_frames(), "--out", folder / "a", "--quiet"});
  ASSERT_EQ(quiet.exit_code, 0) << quiet.err;
  EXPECT_EQ(quiet.out, "");
  EXPECT_EQ(quiet.err, "");
  const Outcome plain = ydd_slam({"run", few_frames(), "--out", folder / "a", "--json"});
  EXPECT_EQ(json::parse(plain.out), json_of(folder / "a/summary.json"));
  EXPECT_THAT(plain.err, HasSubstr("info: frame 0: map started"));
  EXPECT_THAT(plain.err, testing::Not(HasSubstr("\r"))) << "no terminal, no rewriting of lines";
  const Outcome silent =
      ydd_slam({"run", few_frames(), "--out", folder / "a", "--json", "--log-level", "error"});
  EXPECT_EQ(silent.err, "");
  // Warnings stay.
  EXPECT_THAT(ydd_slam({"run", with_corrupt_frame(folder), "--out", folder / "a", "--quiet"}).err,
              HasSubstr("warning: frame 3"));
}

/// Frames of an MP4 file: the count in its table of sample sizes.
std::size_t frames_of_mp4(const std::string& bytes) {
  const auto at = bytes.find("stsz");
  if (at == std::string::npos || at + 16 > bytes.size()) return 0;
  std::size_t count = 0;
  for (std::size_t i = 12; i < 16; ++i) {
    count = count << 8U | static_cast<unsigned char>(bytes[at + i]);
  }
  return count;
}

TEST(Run, WritesAVideoThatIsWholeOrNotThere) {
  const TemporaryFolder folder;
  const fs::path video = folder / "videos/seen.mp4";
  run(few_frames(), folder / "a", {"--video", video.string()});
  EXPECT_EQ(frames_of_mp4(text_of(video)), 6U);
  EXPECT_THAT(names_in(folder / "videos"), testing::ElementsAre("seen.mp4"));
  // A run that fails in the middle leaves the video of what was done.
  const Outcome failed = ydd_slam({"run", with_corrupt_frame(folder), "--out", folder / "b",
                                   "--quiet", "--strict", "--video", folder / "other/seen.mp4"});
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_EQ(frames_of_mp4(text_of(folder / "other/seen.mp4")), 3U);
}

TEST(Run, InRealTimeEveryFrameIsProcessedOrCountedAsDropped) {
  const TemporaryFolder folder;
  run(few_frames(), folder / "a", {"--realtime"});
  const json summary = json_of(folder / "a/summary.json");
  EXPECT_EQ(summary.at("frames_in"), 6);
  EXPECT_EQ(summary.at("frames_processed").get<int>() + summary.at("frames_dropped").get<int>(), 6);
}

TEST(Run, ACoveredLensIsALostSpanNotAFailure) {
  const fs::path covered = small_world(
      "covered", {"--frames", "16", "--set", "covered_from=6", "--set", "covered_frames=4"});
  const TemporaryFolder folder;
  run(covered, folder / "a", {"--deterministic"});
  const json summary = json_of(folder / "a/summary.json");
  EXPECT_EQ(summary.at("lost_spans"), (json{{{"first", 6}, {"last", 9}}}));
  EXPECT_EQ(summary.at("frames_tracked"), 12);
  EXPECT_LT(ate_m(covered, folder / "a"), 0.01);
}

}  // namespace
}  // namespace ydd::e2e
