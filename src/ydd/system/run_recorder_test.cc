// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/run_recorder.h"

#include <memory>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "ydd/system/picture_testing.h"

namespace ydd {
namespace {

using nlohmann::json;
using testing_world::Wall;

/// Three frames tracked, two dark, three tracked; one skipped and four dropped on top.
struct Recorded {
  Wall wall{20};
  SlamSystem system{wall.camera(), options(), ObjectCatalogue::defaults(), nullptr};
  RunRecorder recorder;
  json summary, timings;

  static SystemOptions options() {
    SystemOptions out;
    out.deterministic = true;
    return out;
  }
  Recorded() {
    for (int i = 0; i < 8; ++i) {
      const bool dark = i == 3 || i == 4;
      const auto report = system.process(dark ? wall.dark_frame(i) : wall.frame(i));
      recorder.add(*report);
    }
    recorder.add_skipped(8, "rgb/8.png: \"broken\"");
    recorder.add_dropped(4);
    EXPECT_TRUE(system.finish());
    const RunDescription run{"wall", "full", "boxes.jsonl", true, false, 7};
    summary = json::parse(recorder.summary_json(run, system, 2.0));
    timings = json::parse(recorder.timings_json(system));
  }
};

TEST(RunRecorder, SummaryTellsWhatHappened) {
  const Recorded r;
  const json& s = r.summary;
  EXPECT_EQ(s.at("sequence"), "wall");
  EXPECT_EQ(s.at("variant"), "full");
  EXPECT_EQ(s.at("detector"), "boxes.jsonl");
  EXPECT_EQ(s.at("deterministic"), true);
  EXPECT_EQ(s.at("realtime"), false);
  EXPECT_EQ(s.at("seed"), 7);
  EXPECT_TRUE(s.at("version").is_string());
  EXPECT_EQ(s.at("frames_in"), 13);
  EXPECT_EQ(s.at("frames_processed"), 8);
  EXPECT_EQ(s.at("frames_dropped"), 4);
  EXPECT_EQ(s.at("frames_skipped"), (json{{{"frame", 8}, {"reason", "rgb/8.png: \"broken\""}}}));
  EXPECT_EQ(s.at("frames_tracked"), 6);
  EXPECT_EQ(s.at("lost_spans"), (json{{{"first", 3}, {"last", 4}}}));
  EXPECT_EQ(s.at("loops"), json::array());
  EXPECT_GE(s.at("keyframes_inserted"), 1);
  EXPECT_EQ(s.at("keyframes_kept"), r.system.atlas()->keyframes().size());
  EXPECT_EQ(s.at("map_points"), r.system.atlas()->points().size());
  EXPECT_EQ(s.at("features_requested").at("median"), 1000.0);
  EXPECT_EQ(s.at("features_kept").at("count"), 8);
  EXPECT_EQ(s.at("features_rejected_by_rule").size(), static_cast<std::size_t>(kRuleCount - 1));
  EXPECT_EQ(s.at("features_rejected_by_rule").at("body_depth"), 0);
  EXPECT_EQ(s.at("wall_seconds"), 2.0);
  EXPECT_EQ(s.at("frames_per_second"), 4.0);
  EXPECT_GT(s.at("peak_resident_mb"), 1.0);
  for (const char* stage : {"features", "dynamics", "grid", "initial_pose", "local_map", "total"}) {
    EXPECT_TRUE(s.at("stage_median_cpu_ms").contains(stage)) << stage;
  }
}

TEST(RunRecorder, NamesThatAreNotUtf8AreWrittenWithAMark) {
  Recorded r;
  r.recorder.add_skipped(9, "rgb/\xff.png: broken");
  const RunDescription run{"room\xff", "full", "boxes\xc3.jsonl", true, false, 7};
  const json s = json::parse(r.recorder.summary_json(run, r.system, 2.0));
  EXPECT_EQ(s.at("sequence"), "room\ufffd");
  EXPECT_EQ(s.at("detector"), "boxes\ufffd.jsonl");
  EXPECT_EQ(s.at("frames_skipped").at(1).at("reason"), "rgb/\ufffd.png: broken");
}

TEST(RunRecorder, TimingsHoldStatisticsAndSeries) {
  const Recorded r;
  EXPECT_EQ(r.timings.at("unit"), "ms");
  const json& total = r.timings.at("per_frame").at("total");
  for (const char* clock : {"wall_ms", "cpu_ms"}) {
    for (const char* key : {"count", "median", "mean", "p05", "p95", "p99", "min", "max"}) {
      EXPECT_TRUE(total.at(clock).contains(key)) << clock << " " << key;
    }
  }
  EXPECT_EQ(total.at("wall_ms").at("count"), 8);
  EXPECT_EQ(r.timings.at("series").at("per_frame").at("total").size(), 8U);
  const std::size_t keyframes = r.system.mapping_reports().keyframes.size();
  for (const char* stage : {"insert_keyframe", "cull_points", "create_points", "fuse_points",
                            "local_bundle", "cull_keyframes"}) {
    EXPECT_EQ(r.timings.at("series").at("per_keyframe").at(stage).size(), keyframes) << stage;
    EXPECT_EQ(r.timings.at("per_keyframe").at(stage).at("cpu_ms").at("count"), keyframes);
  }
}

TEST(RunRecorder, FramesTellWhatObjectsWereFoundToDoAndHowMuchAgreed) {
  FrameReport report;
  report.filtered = std::make_shared<const FilteredFeatures>(
      FilteredFeatures{std::make_shared<const Features>(), {}});
  const auto object = [](Rule rule, std::optional<float> log_odds) {
    ObjectJudgement out;
    out.rule = rule;
    out.log_odds = log_odds;
    return out;
  };
  report.judgement.objects = {object(Rule::body_depth, 2.0F), object(Rule::kept, -3.0F),
                              object(Rule::moved_by_hand, 0.5F), object(Rule::kept, std::nullopt),
                              object(Rule::body_depth, std::nullopt)};
  report.track.agreement = 2.0 / 3.0;
  RunRecorder recorder;
  recorder.add(report);
  report.judgement.objects.clear();
  recorder.add(report);
  const json frames = json::parse(recorder.frames_json());
  EXPECT_EQ(frames.at("objects_moving"), (json{2, 0}));
  EXPECT_EQ(frames.at("objects_still"), (json{1, 0}));
  EXPECT_EQ(frames.at("agreement"), (json{0.667, 0.667}));
}

TEST(RunRecorder, NothingRecordedIsStillJson) {
  const Wall wall(2);
  const SlamSystem system(wall.camera(), Recorded::options(), ObjectCatalogue::defaults(), nullptr);
  const RunRecorder recorder;
  const json summary = json::parse(recorder.summary_json({}, system, 0.0));
  EXPECT_EQ(summary.at("frames_in"), 0);
  EXPECT_EQ(summary.at("frames_per_second"), 0.0);
  EXPECT_EQ(summary.at("lost_spans"), json::array());
  EXPECT_EQ(json::parse(recorder.timings_json(system)).at("per_frame"), json::object());
}

}  // namespace
}  // namespace ydd
