// SPDX-License-Identifier: Apache-2.0
#include "ydd/report/html_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ydd {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

StampedPoses path(int count, double shift_m) {
  StampedPoses poses;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d t(0.1 * i + shift_m, i % 3 == 0 ? 0.2 : 0.0, 0.05 * i * i);
    poses.push_back({{1'000'000'000LL + i * 100'000'000LL}, SE3(Eigen::Matrix3d::Identity(), t)});
  }
  return poses;
}

RunReportData sample() {
  RunReportData data;
  data.title = "office <b>&";
  data.summary_json = R"({"sequence": "</script><script>alert(1)</script>"})";
  data.frames_json = R"({"stamp_s": [1.0], "index": [0]})";
  data.timings_json = R"({"unit": "ms", "series": {"per_frame": [1, 2, 3]}})";
  data.config = "orb:\n  features: 1000\n  mark: @DATA@\n";
  data.trajectory = path(30, 0.0);
  return data;
}

json data_of(const std::string& html) {
  const std::string open = R"(id="data">)";
  const auto begin = html.find(open) + open.size();
  return json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(HtmlReport, NeedsNothingFromOutside) {
  const std::string html = html_report(sample()).value();
  for (const char* loads : {"<link", "<iframe", "<img", "<object", "<script src", "@import",
                            "url(http", "url(//", "url('", "url(\"", "sourceMappingURL"}) {
    EXPECT_EQ(count_of(html, loads), 0U) << loads;
  }
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
}

TEST(HtmlReport, HoldsPageLibraryAndLicence) {
  const std::string html = html_report(sample()).value();
  EXPECT_THAT(html, HasSubstr("new Dygraph("));
  EXPECT_THAT(html, HasSubstr("prefers-color-scheme: dark"));
  EXPECT_THAT(html, HasSubstr("MIT licence"));
  EXPECT_GT(html.size(), 100'000U);
  for (const char* mark :
       {"@TITLE@", "@LIBRARY_JS@", "@LIBRARY_CSS@", "@COMMON_JS@", "@PAGE_JS@"}) {
    EXPECT_THAT(html, Not(HasSubstr(mark)));
  }
}

TEST(HtmlReport, TextOfTheRunIsNeverMarkup) {
  const std::string html = html_report(sample()).value();
  EXPECT_THAT(html, HasSubstr("<title>office &lt;b>&amp;</title>"));
  EXPECT_THAT(html, Not(HasSubstr("<script>alert(1)")));
  const json data = data_of(html);
  EXPECT_EQ(data.at("summary").at("sequence"), "</script><script>alert(1)</script>");
  EXPECT_EQ(data.at("title"), "office <b>&");
  EXPECT_EQ(data.at("config"), sample().config) << "marks inside the data stay as they are";
}

std::size_t scripts_of(const std::string& html) { return count_of(html, "<script"); }

TEST(HtmlReport, NoTextOfARunLeavesItsPlace) {
  const std::size_t own = scripts_of(html_report(sample()).value());
  for (const std::string evil : {"</script><script>x()</script>", "<img src=x onerror=x()>",
                                 "<!--<script>", "a&lt;b\u2028\u2029"}) {
    RunReportData data = sample();
    data.title = evil;
    data.config = "variant: " + evil;
    data.moments = {{evil, "Man", true}};
    data.summary_json = json{
        {"sequence", evil},
        {"versions", {{evil, evil}}},
        {"frames_skipped", {{{"frame", 1}, {"reason", evil}}}},
        {"features_rejected_by_rule",
         {{evil, 1}}}}.dump();
    data.frames_json = json{
        {"index", {evil}},
        {"stamp_s", {1.0}},
        {"state", {evil}},
        {"rejected", {{evil, {1}}}},
        {"stages_cpu_ms",
         {{evil, {1}}}}}.dump();
    const std::string html = html_report(data).value();
    EXPECT_EQ(scripts_of(html), own) << evil;
    EXPECT_EQ(count_of(html, "<img"), 0U) << evil;
    EXPECT_EQ(count_of(html, "<!--"), 0U) << evil;
    const auto begin = html.find("id=\"data\">") + 10;
    const std::string block = html.substr(begin, html.find("</script>", begin) - begin);
    EXPECT_EQ(block.find_first_of("<>&"), std::string::npos) << evil;
    EXPECT_EQ(block.find("\u2028"), std::string::npos);
    EXPECT_EQ(block.find("\u2029"), std::string::npos);
    const json read = data_of(html);
    EXPECT_EQ(read.at("title"), evil);
    EXPECT_EQ(read.at("frames"), json::parse(data.frames_json));
    EXPECT_EQ(read.at("summary"), json::parse(data.summary_json));
  }
}

TEST(HtmlReport, OnlyThePagesOwnScriptsMayRun) {
  const std::string html = html_report(sample()).value();
  const std::string open = "script-src 'nonce-";
  const auto at = html.find(open);
  ASSERT_NE(at, std::string::npos);
  const std::string nonce = html.substr(at + open.size(), 16);
  EXPECT_EQ(count_of(html, "<script nonce=\"" + nonce + "\">"), 3U);
  EXPECT_EQ(html, html_report(sample()).value()) << "equal runs, equal reports";
}

TEST(HtmlReport, WithoutGroundTruthThereIsTheBareTrajectory) {
  const json data = data_of(html_report(sample()).value());
  EXPECT_EQ(data.at("trajectory").at("xyz").size(), 30U);
  EXPECT_EQ(data.at("trajectory").at("xyz").at(2), json({0.2, 0.0, 0.2}));
  EXPECT_EQ(data.at("trajectory").at("mean_down"), json({0.0, 1.0, 0.0}));
  EXPECT_EQ(data.at("truth").at("xyz").size(), 0U);
  EXPECT_EQ(data.at("pairs").size(), 0U);
  EXPECT_FALSE(data.contains("evaluation"));
  EXPECT_FALSE(data.at("timings").contains("series"));
}

TEST(HtmlReport, EstimateIsShownWhereTheAlignmentPutsIt) {
  RunReportData data = sample();
  data.groundtruth = path(30, 5.0);
  data.evaluation = evaluate(data.groundtruth, data.trajectory).value();
  const json out = data_of(html_report(data).value());
  EXPECT_EQ(out.at("pairs").size(), 30U);
  for (std::size_t i = 0; i < 30; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(out.at("trajectory").at("xyz").at(i).at(k),
                  out.at("truth").at("xyz").at(i).at(k).get<double>(), 2e-4);
    }
  }
  EXPECT_EQ(out.at("rpe").at("first").size(), out.at("rpe").at("translation_m").size());
  EXPECT_EQ(out.at("rpe").at("first").at(0), 0);
  EXPECT_EQ(out.at("evaluation").at("ate").at("pairs"), 30);
}

TEST(HtmlReport, PicturesAreInside) {
  RunReportData data = sample();
  data.moments = {{"loop", "Man", true}, {"lost", "M"}, {"relocalised", "Ma"}};
  const json moments = data_of(html_report(data).value()).at("moments");
  EXPECT_EQ(moments.at(0).at("image"), "data:image/jpeg;base64,TWFu");
  EXPECT_EQ(moments.at(1).at("image"), "data:image/jpeg;base64,TQ==");
  EXPECT_EQ(moments.at(2).at("image"), "data:image/jpeg;base64,TWE=");
  EXPECT_EQ(moments.at(2).at("caption"), "relocalised");
  EXPECT_EQ(moments.at(0).at("wide"), true);
  EXPECT_EQ(moments.at(2).at("wide"), false);
}

/// A run with errors against `path(30, 5.0)`, and a peer that never saw its beginning.
std::vector<RunReportData> two_runs(const StampedPoses& truth) {
  RunReportData run = sample();
  run.evaluation = evaluate(truth, run.trajectory).value();
  RunReportData peer;
  peer.title = "peer";
  peer.trajectory = path(30, -2.0);
  return {run, peer};
}

TEST(ComparisonReport, PutsEveryRunWhereItsAlignmentPutsIt) {
  const StampedPoses truth = path(30, 5.0);
  const std::string html = comparison_report("busy <room>", truth, two_runs(truth)).value();
  EXPECT_THAT(html, HasSubstr("<title>busy &lt;room></title>"));
  EXPECT_THAT(html, HasSubstr("Settings that differ"));
  const json data = data_of(html);
  ASSERT_EQ(data.at("runs").size(), 2U);
  EXPECT_EQ(data.at("runs").at(0).at("name"), "office <b>&");
  EXPECT_EQ(data.at("runs").at(0).at("pairs").size(), 30U);
  EXPECT_TRUE(data.at("runs").at(1).at("pairs").empty());
  // The peer has no errors of its own and follows the first run to where the truth is.
  for (const std::size_t run : {0U, 1U}) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(data.at("runs").at(run).at("trajectory").at("xyz").at(7).at(k),
                  data.at("truth").at("xyz").at(7).at(k).get<double>(), 2e-4);
    }
  }
}

TEST(ComparisonReport, NamesTheRunThatIsBroken) {
  const StampedPoses truth = path(30, 5.0);
  auto runs = two_runs(truth);
  runs[1].frames_json = "[";
  const auto html = comparison_report("x", truth, runs);
  ASSERT_FALSE(html);
  EXPECT_EQ(html.error().message, "peer: frames of the run: not valid JSON at character 2");
}

TEST(HtmlReport, BrokenJsonIsNamed) {
  RunReportData data = sample();
  data.timings_json = "{\"unit\": ";
  const auto html = html_report(data);
  ASSERT_FALSE(html);
  EXPECT_EQ(html.error().message, "timings of the run: not valid JSON at character 10");
  data.timings_json = "[" + std::string(1'000'000, '[') + std::string(1'000'000, ']') + "]";
  EXPECT_EQ(html_report(data).error().message,
            "timings of the run: JSON nested in more than 64 levels");
}

/// A person who goes half a metre to the right, seen in two frames and not in the third.
std::string walker_jsonl() {
  std::string out;
  for (int i = 0; i < 3; ++i) {
    const json track = {{"id", 4},
                        {"class", "<b>person"},
                        {"position_m", {0.25 * i, 0.0, 2.0}},
                        {"velocity_m_s", {0.25, 0.0, 0.0}},
                        {"extent_m", {0.5, 1.7, 0.2}},
                        {"unseen_s", i == 2 ? 1.0 : 0.0},
                        {"moving", i == 0}};
    out += json{{"frame", i}, {"stamp_s", 1.0 + i}, {"tracks", json::array({track})}}.dump() + "\n";
  }
  return out;
}

TEST(HtmlReport, HoldsPeopleAndThings) {
  RunReportData data = sample();
  EXPECT_EQ(data_of(html_report(data).value())["tracks"], json::array());
  data.tracks_jsonl = walker_jsonl();
  const json tracks = data_of(html_report(data).value())["tracks"];
  ASSERT_EQ(tracks.size(), 1U);
  const json& track = tracks[0];
  EXPECT_EQ(track["id"], 4);
  EXPECT_EQ(track["seen"], 2);
  EXPECT_EQ(track["way_m"], 0.25);
  EXPECT_EQ(track["top_m_s"], 0.25);
  EXPECT_EQ(track["moving"], 0.5);
  EXPECT_EQ(track["xyz"][1], json({0.25, 0.0, 2.0}));
}

TEST(HtmlReport, PeopleAreShownWhereTheTruthIs) {
  RunReportData data = sample();
  data.tracks_jsonl = walker_jsonl();
  data.groundtruth = path(30, 1.0);  // a metre to the right of the estimate
  data.evaluation = evaluate(data.groundtruth, data.trajectory).value();
  const json tracks = data_of(html_report(data).value())["tracks"];
  EXPECT_NEAR(tracks[0]["xyz"][0][0].get<double>(), 1.0, 1e-3);
}

TEST(HtmlReport, TracksThatAreDamagedAreNamedByTheirLine) {
  for (const char* line :
       {"{\"frame\": 1", "[]", "{\"stamp_s\": 1}", "{\"stamp_s\": 1, \"tracks\": [3]}",
        "{\"stamp_s\": 1, \"tracks\": [{\"id\": 1, \"position_m\": [1, 2]}]}",
        "{\"stamp_s\": 1, \"tracks\": [{\"id\": 1, \"position_m\": [1, 2, \"3\"]}]}"}) {
    RunReportData data = sample();
    data.tracks_jsonl = walker_jsonl() + line + "\n";
    const auto html = html_report(data);
    ASSERT_FALSE(html) << line;
    EXPECT_THAT(html.error().message, HasSubstr("line 4")) << line;
  }
}

}  // namespace
}  // namespace ydd
