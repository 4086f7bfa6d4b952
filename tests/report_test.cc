// SPDX-License-Identifier: Apache-2.0
//
// What runs leave to look at, through the binary: the report, its pictures, several runs side by
// side, and folders that only stay when there is something in them.
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "small_world.h"
#include "ydd/image/decode.h"

namespace ydd::e2e {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::string text_of(const fs::path& file) { return read_file(file).value(); }

Outcome run(const fs::path& sequence, const fs::path& out, std::vector<std::string> options) {
  options.insert(options.begin(), {"run", sequence.string(), "--out", out.string(), "--quiet"});
  return ydd_slam(options);
}

/// The data inside a report.
json data_of(const fs::path& report) {
  const std::string html = text_of(report);
  const std::string open = R"(id="data">)";
  const auto begin = html.find(open) + open.size();
  return json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

fs::path covered_lens() {
  return small_world("covered",
                     {"--frames", "16", "--set", "covered_from=6", "--set", "covered_frames=4"});
}

TEST(Report, ShowsWhereTheCameraWasLostAndFound) {
  const TemporaryFolder folder;
  ASSERT_EQ(run(covered_lens(), folder / "a", {"--deterministic"}).exit_code, 0);
  const json list = json::parse(text_of(folder / "a/moments/moments.json"));
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list.at(0).at("kind"), "lost");
  EXPECT_EQ(list.at(0).at("frame"), 6);
  EXPECT_EQ(list.at(1).at("kind"), "found");
  EXPECT_EQ(list.at(1).at("caption"), "Frame 10: found again after 4 frames");
  for (const json& entry : list) {
    const fs::path picture = folder / "a/moments" / entry.at("file").get<std::string>();
    EXPECT_EQ(load_colour(picture).value().width(), 320);
  }
  const json data = data_of(folder / "a/report.html");
  ASSERT_EQ(data.at("moments").size(), 2U);
  EXPECT_THAT(data.at("moments").at(0).at("image").get<std::string>(),
              testing::StartsWith("data:image/jpeg;base64,/9j/"));
  EXPECT_TRUE(data.at("summary").at("versions").contains("OpenCV"));

  // A run into the same folder without such moments leaves none of the old ones.
  ASSERT_EQ(run(few_frames(), folder / "a", {"--deterministic"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder / "a/moments"));
}

TEST(Report, ShowsTheFramesOfWhichMostWasRejected) {
  const TemporaryFolder folder;
  ASSERT_EQ(run(busy_room(), folder / "a",
                {"--deterministic", "--max-frames", "8", "--detections",
                 busy_room() / "detections.jsonl", "--dynamic", "full"})
                .exit_code,
            0);
  const json moments = data_of(folder / "a/report.html").at("moments");
  ASSERT_EQ(moments.size(), 1U) << "the worst of two seconds";
  EXPECT_THAT(moments.at(0).at("caption").get<std::string>(), HasSubstr("rejected"));
}

TEST(Report, EvalRenewsItAndPrintsWhatItAlwaysDid) {
  const TemporaryFolder folder;
  ASSERT_EQ(run(covered_lens(), folder / "a", {"--deterministic"}).exit_code, 0);
  const std::vector<std::string> eval = {"eval",
                                         covered_lens() / "groundtruth.txt",
                                         folder / "a/trajectory.tum",
                                         "--json",
                                         "--rpe-delta",
                                         "0.2"};
  fs::copy_file(folder / "a/trajectory.tum", folder / "elsewhere.tum");
  const std::string before = text_of(folder / "a/report.html");
  const Outcome outcome = ydd_slam(eval);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(json::parse(outcome.out).at("rpe").at("delta"), 0.2);
  EXPECT_NE(text_of(folder / "a/report.html"), before);
  const json data = data_of(folder / "a/report.html");
  EXPECT_EQ(data.at("evaluation"), json::parse(outcome.out));
  EXPECT_EQ(data.at("moments").size(), 2U) << "pictures of the run are still there";
  // Beside any other trajectory nothing appears.
  ASSERT_EQ(
      ydd_slam({"eval", covered_lens() / "groundtruth.txt", folder / "elsewhere.tum"}).exit_code,
      0);
  EXPECT_FALSE(fs::exists(folder / "report.html"));
}

TEST(Report, PutsRunsAndOtherTrajectoriesSideBySide) {
  const TemporaryFolder folder;
  for (const char* const variant : {"off", "full"}) {
    ASSERT_EQ(run(busy_room(), folder / variant,
                  {"--deterministic", "--max-frames", "12", "--detections",
                   busy_room() / "detections.jsonl", "--dynamic", variant})
                  .exit_code,
              0);
  }
  const Outcome outcome = ydd_slam({"report", folder / "off", folder / "full", "--trajectory",
                                    "peer=" + (busy_room() / "groundtruth.txt").string()},
                                   folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "report in comparison.html\n");
  const json runs = data_of(folder / "comparison.html").at("runs");
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_EQ(runs.at(0).at("name"), "off");
  EXPECT_EQ(runs.at(1).at("summary").at("variant"), "full");
  EXPECT_EQ(runs.at(2).at("name"), "peer");
  EXPECT_TRUE(runs.at(2).at("summary").is_null());
  EXPECT_NEAR(runs.at(2).at("evaluation").at("ate").at("absolute_translational_error").at("rmse"),
              0, 1e-6);
}

TEST(Report, OfOneRunIsMadeAnew) {
  const TemporaryFolder folder;
  ASSERT_EQ(run(few_frames(), folder / "a", {"--deterministic"}).exit_code, 0);
  const json before = data_of(folder / "a/report.html");
  fs::remove(folder / "a/report.html");
  const Outcome outcome = ydd_slam({"report", folder / "a"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json after = data_of(folder / "a/report.html");
  for (const char* const part :
       {"title", "summary", "frames", "timings", "config", "truth", "pairs"}) {
    EXPECT_EQ(after.at(part), before.at(part)) << part;
  }
}

TEST(Report, RunsOnDifferentSequencesAreRefused) {
  const TemporaryFolder folder;
  ASSERT_EQ(run(few_frames(), folder / "a", {}).exit_code, 0);
  ASSERT_EQ(run(covered_lens(), folder / "b", {}).exit_code, 0);
  const Outcome outcome = ydd_slam({"report", folder / "a", folder / "b"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
  EXPECT_THAT(outcome.error_lines().front(), HasSubstr("covered"));
  EXPECT_FALSE(fs::exists(folder / "comparison.html"));
}

TEST(RunFolder, AFailedRunLeavesNoFolderAndIsNeverTheLatest) {
  const TemporaryFolder folder;
  std::ofstream(folder / "none.jsonl")
      << R"({"timestamp": "5.0", "detections": [{"cls": "person", "box": [1, 2, 3, 4]}]})"
      << "\n";
  const std::vector<std::string> failing = {"run",          few_frames(),          "--quiet",
                                            "--detections", folder / "none.jsonl", "--frames",
                                            "seen/pictures"};
  EXPECT_EQ(ydd_slam(failing, folder.path()).exit_code, 1);
  EXPECT_FALSE(fs::exists(folder / "runs"));
  EXPECT_FALSE(fs::exists(folder / "seen"));

  ASSERT_EQ(ydd_slam({"run", few_frames(), "--quiet"}, folder.path()).exit_code, 0);
  const fs::path good = fs::read_symlink(folder / "runs/latest");
  EXPECT_EQ(ydd_slam(failing, folder.path()).exit_code, 1);
  EXPECT_EQ(fs::read_symlink(folder / "runs/latest"), good);
  EXPECT_TRUE(fs::exists(folder / "runs/latest/report.html"));
  std::set<std::string> left;
  for (const auto& entry : fs::directory_iterator(folder / "runs")) {
    left.insert(entry.path().filename().string());
  }
  EXPECT_THAT(left, testing::UnorderedElementsAre(good.string(), "latest"));
}

}  // namespace
}  // namespace ydd::e2e
