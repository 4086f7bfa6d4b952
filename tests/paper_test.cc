// SPDX-License-Identifier: Apache-2.0
// `bench paper` on a stand-in for TUM's and Bonn's data: small rendered sequences in folders of the
// right names.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "small_world.h"

namespace ydd::e2e {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kRecorded = "recorded";

/// Links to small worlds in folders as somebody keeps data sets.
struct StandIn {
  TemporaryFolder scratch;
  fs::path data = scratch / "data";
  fs::path out = scratch / "paper";

  StandIn() {
    add("tum/rgbd_dataset_freiburg3_walking_xyz", busy_room());
    add("tum/rgbd_dataset_freiburg3_sitting_static", room());
  }
  void add(const std::string& name, const fs::path& sequence) const {
    fs::create_directories((data / name).parent_path());
    fs::create_directory_symlink(sequence, data / name);
  }
  Outcome bench(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"bench",      "paper",      data.string(), "--out",
                                       out.string(), "--detector", kRecorded};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return ydd_slam(arguments);
  }
  Json json() const { return Json::parse(read_file(out / "paper.json").value()); }
  std::string text(const std::string& name) const { return read_file(out / name).value(); }
};

const Json& cell(const Json& json, std::size_t table, const std::string& row, std::size_t column) {
  for (const Json& candidate : json.at("tables").at(table).at("rows")) {
    if (candidate.at("name") == row) return candidate.at("cells").at(column);
  }
  throw std::logic_error("no row " + row);
}

TEST(BenchPaper, WritesTheArticlesTablesWithOursBeside) {
  const StandIn stand_in;
  const Outcome done = stand_in.bench({"--runs", "1", "--variants", "off", "full"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("fr3_walking_rpy is not below"));
  EXPECT_THAT(done.out, HasSubstr("4 runs (0 from before)"));
  EXPECT_THAT(done.out, HasSubstr("s of the 28.8 s of the published sequence: a clip"));
  const Json json = stand_in.json();
  const Json off = cell(json, 0, "fr3_walking_xyz", 0);
  const Json full = cell(json, 0, "fr3_walking_xyz", 4);
  EXPECT_EQ(full.at("article"), 0.0151);
  EXPECT_TRUE(cell(json, 0, "fr3_walking_rpy", 4).at("ours").is_null());
  if (!kSanitized) {
    EXPECT_LT(full.at("ours").get<double>(), 0.1);
    EXPECT_LT(full.at("ours").get<double>(), off.at("ours").get<double>());
  }
  // Memory and time, which every machine has.
  const std::size_t twelve = 9, ten = 7;
  for (const std::size_t column : {0U, 1U, 2U, 3U}) {
    EXPECT_GT(cell(json, twelve, "YDD-SLAM (CPU) / full", column).at("ours").get<double>(), 0);
  }
  EXPECT_GT(cell(json, ten, "fr3_walking_xyz", 0).at("ours").get<double>(), 0);
  EXPECT_THAT(stand_in.text("paper.html"), HasSubstr("Figure 16"));
  EXPECT_THAT(stand_in.text("paper.tex"), HasSubstr("fr3\\_walking\\_xyz"));
}

TEST(BenchPaper, GoesOnWhereItStoppedAndMakesAgainWhatIsDamagedOrOfOtherSettings) {
  const StandIn stand_in;
  const std::vector<std::string> two{"--runs", "1", "--variants", "full"};
  ASSERT_EQ(stand_in.bench(two).exit_code, 0);
  const fs::path runs = stand_in.out / "runs";
  const fs::path kept = runs / "fr3_sitting_static/full-1.json";
  const std::string before = read_file(kept).value();
  std::ofstream(runs / "fr3_walking_xyz/full-1.json") << before.substr(0, 100);
  const Outcome again = stand_in.bench(two);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("2 runs (1 from before)"));
  EXPECT_THAT(again.err, HasSubstr("fr3_walking_xyz/full-1.json"));
  EXPECT_THAT(again.err, HasSubstr("the run is made again"));
  EXPECT_EQ(read_file(kept).value(), before);
  const Outcome more = stand_in.bench({"--runs", "2", "--variants", "full"});
  EXPECT_THAT(more.out, HasSubstr("4 runs (2 from before)"));
  EXPECT_EQ(cell(stand_in.json(), 0, "fr3_walking_xyz", 4).at("runs"), 2);
  const Outcome other = stand_in.bench(
      {"--runs", "1", "--variants", "full", "--set", "dynamics.compensation.points=800"});
  EXPECT_THAT(other.out, HasSubstr("2 runs (0 from before)"));
  EXPECT_THAT(other.err, HasSubstr("of other settings"));
}

TEST(BenchPaper, AskedToEndItKeepsWhatIsDoneAndTheSameCommandGoesOn) {
  const StandIn stand_in;
  std::vector<std::string> command{YDD_BINARY,   "bench",      "paper",  stand_in.data.string(),
                                   "--out",      stand_in.out, "--runs", "5",
                                   "--detector", kRecorded};
  std::vector<std::string> timed{"timeout", "--preserve-status", "-s", "INT", "3"};
  timed.insert(timed.end(), command.begin(), command.end());
  const Outcome ended = run_program(timed);
  // A machine that is quick enough is done before.
  EXPECT_TRUE(ended.exit_code == 130 || ended.exit_code == 0) << ended.exit_code;
  if (ended.exit_code == 130) {
    ASSERT_EQ(ended.error_lines().size(), 1U) << ended.err;
    EXPECT_THAT(ended.error_lines()[0], HasSubstr("the same command goes on there"));
  }
  std::size_t kept = 0;
  for (const auto& entry : fs::recursive_directory_iterator(stand_in.out)) {
    if (entry.path().extension() == ".json" && entry.path().filename() != "paper.json") ++kept;
  }
  const Outcome done = stand_in.bench({"--runs", "1", "--variants", "off"});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  const std::size_t expected = std::min<std::size_t>(kept, 1);  // the first of all is off
  EXPECT_THAT(done.out,
              HasSubstr(fmt::format("2 runs ({} from before)", kept >= 6 ? 2 : expected)));
}

TEST(BenchPaper, ASequenceThatCannotBeReadIsNamedAndTheRestRuns) {
  const StandIn stand_in;
  const fs::path broken = stand_in.data / "rgbd_dataset_freiburg3_walking_rpy";
  fs::create_directories(broken);
  std::ofstream(broken / "rgb.txt") << "no list\n";
  const Outcome done = stand_in.bench({"--runs", "1", "--variants", "off"});
  EXPECT_EQ(done.exit_code, 1);
  ASSERT_EQ(done.error_lines().size(), 1U) << done.err;
  EXPECT_THAT(done.error_lines()[0], HasSubstr("1 of 3 runs failed"));
  EXPECT_THAT(done.error_lines()[0], HasSubstr("fr3_walking_rpy"));
  EXPECT_THAT(stand_in.text("paper.html"), HasSubstr("failed: fr3_walking_rpy, off, run 1"));
  EXPECT_TRUE(cell(stand_in.json(), 0, "fr3_walking_xyz", 0).at("ours").is_number());
}

TEST(BenchPaper, TakesTrajectoriesOfOtherSystemsAndRecordingsOfOnesOwn) {
  const StandIn stand_in;
  const fs::path systems = stand_in.scratch / "systems";
  for (const char* name : {"DS-SLAM", "Other"}) fs::create_directories(systems / name);
  const fs::path truth = busy_room() / "groundtruth.txt";
  fs::copy_file(truth, systems / "DS-SLAM/fr3_w_xyz.txt");
  fs::copy_file(truth, systems / "Other/rgbd_dataset_freiburg3_walking_xyz_1.txt");
  fs::copy_file(truth, systems / "Other/rgbd_dataset_freiburg3_walking_xyz_2.txt");
  std::ofstream(systems / "Other/fr3_sitting_static.txt") << "1 2 3\n";
  std::ofstream(systems / "Other/elsewhere.txt") << "1 0 0 0 0 0 0 1\n";
  const Outcome done = stand_in.bench({"--runs", "1", "--variants", "off", "--systems",
                                       systems.string(), "--own", "linear=" + room().string()});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("fr3_sitting_static.txt:1:"));
  EXPECT_THAT(done.out, HasSubstr("elsewhere.txt: of no sequence that is here"));
  EXPECT_THAT(done.out, Not(HasSubstr("table 13")));
  const Json json = stand_in.json();
  const Json& nine = json.at("tables").at(6);
  EXPECT_EQ(nine.at("columns").back(), "Other (here)");
  EXPECT_EQ(nine.at("rows").at(0).at("cells").back().at("runs"), 2);
  EXPECT_LT(nine.at("rows").at(0).at("cells").at(3).at("ours").get<double>(), 1e-6);
  EXPECT_GT(cell(json, 10, "linear", 0).at("ours").get<double>(), 0);
}

TEST(BenchPaper, RunsCanBeMadeOneByOneAndGathered) {
  const StandIn stand_in;
  const auto with = [](std::vector<std::string> more) {
    more.insert(more.end(), {"--runs", "2", "--variants", "off", "full"});
    return more;
  };
  const Outcome plan = stand_in.bench(with({"--plan"}));
  EXPECT_THAT(plan.out, HasSubstr("fr3_sitting_static full 2 missing\n"));
  EXPECT_EQ(std::count(plan.out.begin(), plan.out.end(), '\n'), 8);
  EXPECT_FALSE(fs::exists(stand_in.out));
  const Outcome one = stand_in.bench(with({"--one", "fr3_sitting_static", "full", "2"}));
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_TRUE(fs::exists(stand_in.out / "runs/fr3_sitting_static/full-2.json"));
  EXPECT_FALSE(fs::exists(stand_in.out / "paper.html"));
  EXPECT_THAT(stand_in.bench(with({"--plan"})).out, HasSubstr("fr3_sitting_static full 2 there\n"));
  const Outcome other = stand_in.bench(with({"--one", "fr3_sitting_static", "full", "3"}));
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("--plan names them all"));
  const Outcome gathered = stand_in.bench(with({"--gather"}));
  EXPECT_EQ(gathered.exit_code, 1);
  EXPECT_THAT(gathered.err, HasSubstr("7 of 8 runs are not there"));
  EXPECT_EQ(cell(stand_in.json(), 0, "fr3_sitting_static", 4).at("runs"), 1);
}

TEST(BenchPaper, BadInputIsOneLine) {
  const StandIn stand_in;
  const TemporaryFolder empty;
  const std::vector<std::vector<std::string>> calls{
      {"bench", "paper", empty / "", "--out", empty / "p"},
      {"bench", "paper", empty / "nowhere", "--out", empty / "p"},
      {"bench", "paper", stand_in.data.string(), "--own", "a/b=c", "--out", empty / "p"},
      {"bench", "paper", stand_in.data.string(), "--own", "fr3_walking_xyz=c", "--out",
       empty / "p"}};
  for (const std::vector<std::string>& call : calls) {
    const Outcome done = ydd_slam(call);
    EXPECT_EQ(done.exit_code, 1);
    EXPECT_EQ(done.error_lines().size(), 1U) << done.err;
  }
  EXPECT_EQ(ydd_slam({"bench", "paper", "x", "--runs", "0"}).exit_code, 2);
  EXPECT_EQ(ydd_slam({"bench", "paper", "x", "--variants", "half"}).exit_code, 2);
}

}  // namespace
}  // namespace ydd::e2e
