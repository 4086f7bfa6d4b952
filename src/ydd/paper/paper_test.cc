// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/evaluation/rpe.h"
#include "ydd/paper/article.h"
#include "ydd/paper/paper_report.h"
#include "ydd/paper/paper_sequences.h"
#include "ydd/paper/run_figures.h"
#include "ydd/paper/svg_plot.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const ArticleTable& table_number(const Article& article, int number) {
  for (const ArticleTable& table : article.tables) {
    if (table.number == number) return table;
  }
  throw std::logic_error("no such table");
}

const PaperTable& table_number(const std::vector<PaperTable>& tables, int number) {
  for (const PaperTable& table : tables) {
    if (table.number == number) return table;
  }
  throw std::logic_error("no such table");
}

RunFigures run_with(const std::string& sequence, const std::string& variant, int run,
                    std::map<std::string, double> values) {
  return {"settings", sequence, variant, run, std::move(values), {}};
}

// --- the article -------------------------------------------------------------------------------

TEST(Article, HasItsElevenTables) {
  std::vector<int> numbers;
  for (const ArticleTable& table : article().tables) numbers.push_back(table.number);
  EXPECT_THAT(numbers, ElementsAre(3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13));
}

/// What was typed in is checked by what the article computed from it: improvements of tables 3 to 5
/// follow from their other columns, within what four digits leave open.
TEST(Article, ImprovementsFollowFromTheFigures) {
  const Article all = article();
  int checked = 0;
  for (const int number : {3, 4, 5}) {
    for (const ArticleRow& row : table_number(all, number).rows) {
      for (std::size_t i = 0; i < 4; ++i) {
        const double before = *row.figures[i], after = *row.figures[i + 4];
        const double improvement = *row.figures[i + 8];
        const bool misprint = number == 5 && row.name == "fr3_sitting_static" && i == 0;
        const double open = 100 * 1.1e-4 / before + 0.02;
        EXPECT_EQ(std::abs(100 * (before - after) / before - improvement) > open, misprint)
            << "table " << number << ", " << row.name << ", column " << i;
        ++checked;
      }
    }
  }
  EXPECT_EQ(checked, 60);
}

/// Squares of mean and S.D. sum up to that of the RMSE, in the mean of five runs nearly.
TEST(Article, MeanAndDeviationFitTheRmse) {
  const Article all = article();
  for (const int number : {3, 4, 5}) {
    for (const ArticleRow& row : table_number(all, number).rows) {
      const double rmse = std::hypot(*row.figures[5], *row.figures[7]);
      EXPECT_NEAR(*row.figures[4], rmse, 2e-4) << "table " << number << ", " << row.name;
    }
  }
}

/// Tables 6 to 9 repeat figures of tables 3 to 5.
TEST(Article, TablesAgreeWithEachOther) {
  const Article all = article();
  const auto check = [&](int first, int again, double tolerance) {
    for (const ArticleRow& row : table_number(all, again).rows) {
      const auto& rows = table_number(all, first).rows;
      const auto same = std::find_if(rows.begin(), rows.end(), [&](const ArticleRow& other) {
        return other.name == row.name;
      });
      ASSERT_NE(same, rows.end()) << row.name;
      EXPECT_EQ(same->figures[0], row.figures.front()) << again << row.name;
      EXPECT_NEAR(*same->figures[4], *row.figures.back(), tolerance) << again << row.name;
    }
  };
  check(3, 6, 0);
  check(4, 7, 1.01e-4);  // fr3_walking_rpy: 0.0212 there, 0.0213 here
  check(5, 8, 0);
  check(3, 9, 0);
}

/// The text says: CPU between 68.9 and 70.7 ms, CPU + GPU between 14.7 and 17.3 ms.
TEST(Article, TimesAreWithinWhatTheTextSays) {
  const Article all = article();
  for (const ArticleRow& row : table_number(all, 10).rows) {
    for (const std::size_t i : {0U, 1U}) {
      EXPECT_GT(*row.figures[i], 68.9);
      EXPECT_LT(*row.figures[i], 70.7);
    }
    for (const std::size_t i : {2U, 3U}) {
      EXPECT_GT(*row.figures[i], 14.7);
      EXPECT_LT(*row.figures[i], 17.3);
    }
  }
}

TEST(Article, DamagedTextIsOneLineThatNamesIt) {
  for (const char* text :
       {"", "[]", "{}", "{\"source\": \"s\"}", R"({"source": "s", "tables": [{}]})",
        R"({"source": "s", "tables": [{"number": "3"}]})",
        R"({"source": "s", "tables": [{"number": 3, "caption": "c", "unit": "m",
            "columns": [{"name": "a"}], "rows": [{"name": "r", "figures": [1, 2]}]}]})"}) {
    const auto read = parse_article(text, "some.json");
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_THAT(read.error().message, HasSubstr("some.json"));
    EXPECT_THAT(read.error().message, Not(HasSubstr("\n")));
  }
}

// --- sequences ---------------------------------------------------------------------------------

TEST(PaperSequences, AreKnownByWhateverTheirFoldersAreCalled) {
  EXPECT_EQ(sequence_name("rgbd_dataset_freiburg3_walking_xyz"), "fr3_walking_xyz");
  EXPECT_EQ(sequence_name("tum_fr3_walking_halfsphere"), "fr3_walking_halfsphere");
  EXPECT_EQ(sequence_name("fr3_w_half"), "fr3_walking_halfsphere");
  EXPECT_EQ(sequence_name("FR3_SIT_STATIC_2"), "fr3_sitting_static");
  EXPECT_EQ(sequence_name("rgbd_bonn_crowd2"), "bonn_crowd2");
  EXPECT_EQ(sequence_name("rgbd_dataset_freiburg3_walking_xyz_validation"), std::nullopt);
  EXPECT_EQ(sequence_name("rgbd_dataset_freiburg1_xyz"), std::nullopt);
  EXPECT_EQ(sequence_name("fr3_walking_staticky"), std::nullopt);
  EXPECT_EQ(sequence_name("bonn_"), std::nullopt);
  EXPECT_EQ(sequence_name(std::string(100000, 'f')), std::nullopt);
}

TEST(PaperSequences, AreFoundAtAnyDepthAndMissingOnesAreNamed) {
  const TemporaryFolder scratch;
  const auto make = [&](const std::string& name) {
    fs::create_directories(scratch / name);
    ASSERT_TRUE(write_file_atomically(fs::path(scratch / name) / "rgb.txt", "x").ok());
  };
  make("a/b/rgbd_dataset_freiburg3_sitting_static");
  make("a/rgbd_dataset_freiburg3_walking_xyz");
  make("z/fr3_walking_xyz");
  make("rgbd_dataset_freiburg3_sitting_xyz");
  make("bonn/rgbd_bonn_crowd");
  make("other");
  fs::create_directories(scratch / "rgbd_dataset_freiburg3_walking_rpy");  // no pictures in it
  const auto found = find_paper_sequences(scratch / "");
  ASSERT_TRUE(found.ok()) << found.error().message;
  std::vector<std::string> names;
  for (const PaperSequence& sequence : found->sequences) names.push_back(sequence.name);
  EXPECT_THAT(
      names, ElementsAre("fr3_walking_xyz", "fr3_sitting_static", "fr3_sitting_xyz", "bonn_crowd"));
  EXPECT_THAT(found->missing,
              ElementsAre("fr3_walking_rpy", "fr3_walking_halfsphere", "fr3_walking_static"));
  ASSERT_EQ(found->duplicates.size(), 1U);
  EXPECT_EQ(found->duplicates[0].filename(), "fr3_walking_xyz");
  EXPECT_FALSE(find_paper_sequences(scratch / "nowhere").ok());
}

// --- runs --------------------------------------------------------------------------------------

StampedPoses walk(double yaw_rad_per_frame, double step_m) {
  StampedPoses poses;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(yaw_rad_per_frame * i, Eigen::Vector3d::UnitY()).toRotationMatrix();
    poses.push_back({Timestamp{i * 33'000'000LL}, SE3(R, {step_m * i, 0.01 * i * i, 0.1})});
  }
  return poses;
}

TEST(RunFigures, RpeIsPerFrameAndItsRotationIsTheNormOfTheMatrix) {
  RunFigures run;
  score_trajectory(walk(0, 0.1), walk(0.02, 0.1), run);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const double norm = (R - Eigen::Matrix3d::Identity()).norm();
  EXPECT_NEAR(run.values.at("rpe_rotation.mean"), norm, 1e-9);
  EXPECT_NEAR(run.values.at("rpe_rotation.rmse"), norm, 1e-9);
  EXPECT_EQ(run.curves.truth_m.size(), 20U);
  EXPECT_EQ(run.curves.rpe_m.size(), run.curves.rpe_stamp_s.size());
  EXPECT_NEAR(run.curves.rpe_stamp_s.at(1), 0.033, 1e-9);
  RunFigures exact;
  score_trajectory(walk(0, 0.1), walk(0, 0.1), exact);
  EXPECT_NEAR(exact.values.at("ate_m.rmse"), 0, 1e-9);
  EXPECT_NEAR(exact.values.at("rpe_m.rmse"), 0, 1e-9);
}

TEST(RunFigures, TooShortATrajectoryHasNoError) {
  RunFigures run;
  score_trajectory(walk(0, 0.1), {walk(0, 0.1)[0]}, run);
  EXPECT_TRUE(run.values.empty());
}

TEST(RunFigures, ComeBackFromTheirFile) {
  RunFigures run = run_with("fr3_walking_xyz", "full", 3, {{"tracked_share", 1.0}});
  score_trajectory(walk(0, 0.1), walk(0.02, 0.1), run);
  run.curves.requested = {1000, 1500};
  const std::string text = run_figures_json(run);
  const auto again = parse_run_figures(text, "run.json");
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(run_figures_json(*again), text);
  EXPECT_EQ(again->values, run.values);
  EXPECT_EQ(again->run, 3);
}

TEST(RunFigures, DamagedFilesAreRefusedByName) {
  RunFigures run = run_with("s", "v", 1, {{"a", 1.0}});
  score_trajectory(walk(0, 0.1), walk(0.02, 0.1), run);
  const std::string whole = run_figures_json(run);
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    const auto read = parse_run_figures(whole.substr(0, length), "run.json");
    ASSERT_FALSE(read.ok()) << length;
    EXPECT_THAT(read.error().message, HasSubstr("run.json"));
    EXPECT_THAT(read.error().message, Not(HasSubstr("\n")));
  }
  for (const char* key : {"settings", "values", "truth_m", "rpe_m", "requested", "run"}) {
    auto json = nlohmann::ordered_json::parse(whole);
    json.erase(key);
    EXPECT_FALSE(parse_run_figures(json.dump(), "run.json").ok()) << key;
    json[key] = {{"x", "y"}};
    EXPECT_FALSE(parse_run_figures(json.dump(), "run.json").ok()) << key;
  }
  auto json = nlohmann::ordered_json::parse(whole);
  json["rpe_m"].erase(0);
  EXPECT_THAT(parse_run_figures(json.dump(), "run.json").error().message,
              HasSubstr("different lengths"));
}

// --- tables ------------------------------------------------------------------------------------

std::vector<RunFigures> some_runs() {
  const auto ate = [](double rmse) {
    return std::map<std::string, double>{{"ate_m.rmse", rmse}, {"resident_mb", 50}};
  };
  return {run_with("fr3_walking_xyz", "off", 1, ate(0.2)),
          run_with("fr3_walking_xyz", "off", 2, ate(0.4)),
          run_with("fr3_walking_xyz", "full", 1, ate(0.014)),
          run_with("fr3_walking_xyz", "full", 2, ate(0.016)),
          run_with("fr3_walking_rpy", "full", 1, ate(0.1)),
          run_with("fr3_walking_rpy", "full", 2, {}),
          run_with("fr3_walking_xyz", "evidence", 1, ate(0.01)),
          run_with("bonn_crowd", "full", 1, ate(0.02)),
          run_with("linear", "full", 1, {{"tracking_ms.median", 10.0}})};
}

std::vector<PaperTable> some_tables() {
  const std::vector<RunFigures> systems{
      run_with("fr3_walking_xyz", "DS-SLAM", 1, {{"ate_m.rmse", 0.03}}),
      run_with("fr3_walking_xyz", "NGD-SLAM", 1, {{"ate_m.rmse", 0.015}})};
  const std::vector<std::string> own{"linear"};
  return fill_tables(article(), some_runs(), systems, own);
}

TEST(PaperTables, HoldTheMeanOfTheRunsBesideTheArticlesFigure) {
  const PaperTable table = table_number(some_tables(), 3);
  const PaperRow& row = table.rows.at(0);
  EXPECT_EQ(table.columns.at(0), "ORB-SLAM3 RMSE / off");
  EXPECT_NEAR(row.cells.at(0).ours->mean, 0.3, 1e-12);
  EXPECT_EQ(row.cells.at(0).ours->low, 0.2);
  EXPECT_EQ(row.cells.at(0).ours->high, 0.4);
  EXPECT_EQ(row.cells.at(0).article, 0.6930);
  EXPECT_EQ(row.cells.at(0).distance, Distance::better);
  EXPECT_NEAR(row.cells.at(4).ours->mean, 0.015, 1e-12);
  EXPECT_EQ(row.cells.at(4).distance, Distance::near);
  EXPECT_NEAR(row.cells.at(8).ours->mean, 95.0, 1e-9);
  EXPECT_EQ(row.cells.at(8).article, 97.82);
  EXPECT_EQ(row.cells.at(8).distance, Distance::near);
  EXPECT_FALSE(row.cells.at(1).ours.has_value());
}

TEST(PaperTables, MarkWhatIsFarFromTheArticleAndCountOnlyRunsWithAFigure) {
  const PaperTable table = table_number(some_tables(), 3);
  const PaperCell& far = table.rows.at(1).cells.at(4);
  EXPECT_EQ(far.ours->runs, 1);
  EXPECT_EQ(far.distance, Distance::worse);
  const PaperCell& missing = table.rows.at(2).cells.at(4);
  EXPECT_FALSE(missing.ours.has_value());
  EXPECT_EQ(missing.article, 0.0275);
  EXPECT_EQ(missing.distance, Distance::unknown);
}

TEST(PaperTables, TakeInWhatTheArticleDoesNotHave) {
  const std::vector<PaperTable> tables = some_tables();
  const PaperTable& six = table_number(tables, 6);
  EXPECT_EQ(six.columns.back(), "evidence");
  EXPECT_EQ(six.rows.at(0).cells.back().ours->mean, 0.01);
  EXPECT_FALSE(six.rows.at(0).cells.back().article.has_value());
  EXPECT_EQ(six.rows.back().name, "bonn_crowd");
  for (const PaperRow& row : six.rows) EXPECT_EQ(row.cells.size(), six.columns.size());
  const PaperTable& nine = table_number(tables, 9);
  EXPECT_EQ(nine.columns.back(), "NGD-SLAM (here)");
  EXPECT_EQ(nine.rows.at(0).cells.back().ours->mean, 0.015);
  EXPECT_EQ(nine.columns.at(3), "DS-SLAM");
  EXPECT_EQ(nine.rows.at(0).cells.at(3).ours->mean, 0.03);
  const PaperTable& twelve = table_number(tables, 12);
  EXPECT_EQ(twelve.rows.back().name, "evidence");
  EXPECT_EQ(twelve.rows.at(2).cells.at(1).ours->mean, 50);  // over two sequences
  const PaperTable& thirteen = table_number(tables, 13);
  EXPECT_EQ(thirteen.rows.size(), 2U);
  EXPECT_EQ(thirteen.rows.at(0).cells.at(2).ours->mean, 10);
}

TEST(PaperTables, WithoutEvidenceThereIsNoColumnForIt) {
  const std::vector<RunFigures> runs{run_with("fr3_walking_xyz", "off", 1, {{"ate_m.rmse", 1}})};
  const std::vector<PaperTable> tables = fill_tables(article(), runs, {}, {});
  EXPECT_EQ(table_number(tables, 6).columns.size(), 4U);
  EXPECT_EQ(table_number(tables, 12).rows.size(), 5U);
}

// --- pages -------------------------------------------------------------------------------------

PaperReport some_report() {
  PaperReport report;
  report.source = "The article";
  report.tables = some_tables();
  report.runs = some_runs();
  for (RunFigures& run : report.runs) {
    run.curves.truth_m = {{0, 0, 0}, {1, 0, 0.5}, {2, 0, 0}};
    run.curves.estimate_m = {{0, 0.1, 0}, {1, 0, 0.6}, {2, 0, 0}};
    run.curves.requested = {1000, 2000, 3500};
  }
  report.own = {"linear"};
  report.remarks = {"<b>50 % of _this_ & that</b> is $missing$"};
  report.facts = {{"Machine", "two {cores}"}};
  return report;
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(PaperPage, HasAllTablesAndFiguresAndNoMarkupOfOthers) {
  const std::string page = paper_page(some_report());
  for (const int number : {3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13}) {
    EXPECT_THAT(page, HasSubstr(fmt::format("Table {}:", number)));
  }
  for (const int number : {13, 15, 16, 19}) {
    EXPECT_THAT(page, HasSubstr(fmt::format("Figure {}:", number)));
  }
  EXPECT_THAT(page, HasSubstr("&lt;b&gt;50 %"));
  EXPECT_THAT(page, Not(HasSubstr("<b>50 %")));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, HasSubstr("⊕</b><i>0.6930</i>"));
  EXPECT_EQ(count_of(page, "<svg"), count_of(page, "</svg>"));
  EXPECT_GT(count_of(page, "<svg"), 8U);
}

TEST(PaperPage, SaysWhatCouldNotBeDrawn) {
  PaperReport report = some_report();
  report.runs.clear();
  EXPECT_EQ(count_of(paper_page(report), "Not drawn"), 4U);
}

TEST(PaperLatex, HasOneRowOfCellsForEachRowAndEscapesText) {
  const PaperReport report = some_report();
  const std::string latex = paper_latex(report);
  EXPECT_THAT(latex, HasSubstr("50 \\% of \\_this\\_ \\& that"));
  EXPECT_THAT(latex, HasSubstr("two \\{cores\\}"));
  EXPECT_THAT(latex, HasSubstr("fr3\\_walking\\_xyz & 0.3000$^{\\oplus}$ (0.6930)"));
  EXPECT_EQ(count_of(latex, "\\begin{tabular}"), 11U);
  EXPECT_EQ(count_of(latex, "{") - count_of(latex, "\\{"),
            count_of(latex, "}") - count_of(latex, "\\}"));
}

TEST(PaperJson, SaysForEachCellHowFarItIsAndCanBeCompared) {
  const auto json = nlohmann::ordered_json::parse(paper_json(some_report(), R"({"cores": 2})"));
  const auto& cell = json.at("tables").at(0).at("rows").at(0).at("cells").at(0);
  EXPECT_NEAR(cell.at("ours").get<double>(), 0.3, 1e-12);
  EXPECT_EQ(cell.at("article"), 0.6930);
  EXPECT_EQ(cell.at("distance"), "far, better");
  const auto& figures = json.at("groups").at("paper").at("figures");
  EXPECT_EQ(figures.at("fr3_walking_xyz/off/ate_rmse_m").at("max"), 0.4);
  EXPECT_EQ(figures.at("fr3_walking_rpy/full/ate_rmse_m").at("runs").size(), 1U);
  EXPECT_TRUE(figures.at("linear/full/ate_rmse_m").at("median").is_null());
  EXPECT_EQ(json.at("groups").at("paper").at("machine").at("cores"), 2);
}

TEST(SvgPlot, ThinsLongLinesButKeepsTheirPeaks) {
  Plot plot{"t", "x", "y", {}, false, true};
  PlotLine line{"l", "red", {}};
  for (int i = 0; i < 50000; ++i) line.points.emplace_back(i, i == 31234 ? 100.0 : 1.0);
  plot.lines.push_back(line);
  const std::string svg = svg_plot(plot);
  EXPECT_LT(svg.size(), 40000U);
  plot.lines[0].points[31234].y() = 1.0;
  EXPECT_NE(svg, svg_plot(plot));
}

TEST(SvgPlot, OnePointAndNoneAreDrawnWithoutNonsense) {
  const Plot empty{"t", "x", "y", {}};
  EXPECT_THAT(svg_plot(empty), HasSubstr("nothing to draw"));
  const Plot one{"t", "x", "y", {{"l", "red", {{1, 1}}}}, true};
  EXPECT_THAT(svg_plot(one), Not(HasSubstr("nan")));
  EXPECT_THAT(svg_plot(one), Not(HasSubstr("inf")));
}

}  // namespace
}  // namespace ydd
