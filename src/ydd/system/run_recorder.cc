// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/run_recorder.h"

#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "ydd/base/version.h"

namespace ydd {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const SeriesStatistics& s) {
  return {{"count", s.count}, {"median", s.median}, {"mean", s.mean}, {"p05", s.p05},
          {"p95", s.p95},     {"p99", s.p99},       {"min", s.min},   {"max", s.max}};
}

template <class Series>
Json stages_to_json(const std::map<std::string, Series>& stages) {
  Json out = Json::object();
  for (const auto& [stage, series] : stages) {
    out[stage] = {{"wall_ms", to_json(statistics_of(series.wall_ms))},
                  {"cpu_ms", to_json(statistics_of(series.cpu_ms))}};
  }
  return out;
}

template <class Series>
Json series_to_json(const std::map<std::string, Series>& stages) {
  Json out = Json::object();
  for (const auto& [stage, series] : stages) out[stage] = series.wall_ms;
  return out;
}

}  // namespace

double peak_resident_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void RunRecorder::add(const FrameReport& report) {
  ++processed_;
  if (report.keyframe) ++keyframes_;
  if (report.track.state == TrackingState::tracking) {
    ++tracked_;
  } else if (!lost_.empty() && lost_.back().last + 1 == report.index) {
    lost_.back().last = report.index;
  } else {
    lost_.push_back({report.index, report.index});
  }
  requested_.push_back(report.requested);
  kept_.push_back(static_cast<double>(report.observations->features.size()));
  const auto rules = count_rules(*report.observations);
  for (std::size_t i = 0; i < rules.size(); ++i) rules_[i] += rules[i];
  for (const StageTime& t : report.times) {
    stages_[t.stage].wall_ms.push_back(t.wall_ms);
    stages_[t.stage].cpu_ms.push_back(t.cpu_ms);
  }
}

void RunRecorder::add_skipped(std::int64_t frame, const std::string& reason) {
  skipped_.emplace_back(frame, reason);
}

std::map<std::string, RunRecorder::Series> RunRecorder::mapper_series(const SlamSystem& system) {
  std::map<std::string, Series> stages;
  const auto add = [&](const StageTimes& times) {
    for (const StageTime& t : times) {
      stages[t.stage].wall_ms.push_back(t.wall_ms);
      stages[t.stage].cpu_ms.push_back(t.cpu_ms);
    }
  };
  const MappingReports reports = system.mapping_reports();
  for (const MapperReport& report : reports.keyframes) add(report.times);
  add(reports.loop_times);
  return stages;
}

std::string RunRecorder::summary_json(const RunDescription& run, const SlamSystem& system,
                                      double wall_seconds) const {
  const auto atlas = system.atlas();
  Json lost = Json::array();
  for (const Span& span : lost_) lost.push_back({{"first", span.first}, {"last", span.last}});
  Json skipped = Json::array();
  for (const auto& [frame, reason] : skipped_) {
    skipped.push_back({{"frame", frame}, {"reason", reason}});
  }
  Json rejected = Json::object();
  for (std::size_t i = 1; i < rules_.size(); ++i) {
    rejected[std::string(to_string(static_cast<Rule>(i)))] = rules_[i];
  }
  Json medians = Json::object();
  for (const auto& [stage, series] : stages_) {
    medians[stage] = statistics_of(series.cpu_ms).median;
  }
  Json loops = Json::array();
  for (const LoopReport& loop : system.mapping_reports().loops) {
    loops.push_back({{"frame", loop.current_frame},
                     {"matched_frame", loop.matched_frame},
                     {"points", loop.inliers},
                     {"shift_m", loop.shift_m},
                     {"welded_maps", loop.welded}});
  }
  const auto frames_in = processed_ + dropped_ + static_cast<int>(skipped_.size());
  const Json out = {
      {"version", kVersion},
      {"sequence", run.sequence},
      {"variant", run.variant},
      {"detector", run.detector},
      {"deterministic", run.deterministic},
      {"realtime", run.realtime},
      {"seed", run.seed},
      {"frames_in", frames_in},
      {"frames_processed", processed_},
      {"frames_dropped", dropped_},
      {"frames_skipped", skipped},
      {"frames_tracked", tracked_},
      {"lost_spans", lost},
      {"loops", loops},
      {"keyframes_inserted", keyframes_},
      {"keyframes_kept", atlas->keyframes().size()},
      {"map_points", atlas->points().size()},
      {"features_requested", to_json(statistics_of(requested_))},
      {"features_kept", to_json(statistics_of(kept_))},
      {"features_rejected_by_rule", rejected},
      {"wall_seconds", wall_seconds},
      {"frames_per_second", wall_seconds > 0 ? processed_ / wall_seconds : 0.0},
      {"peak_resident_mb", peak_resident_mb()},
      {"stage_median_cpu_ms", medians},
  };
  return out.dump(2) + "\n";
}

std::string RunRecorder::timings_json(const SlamSystem& system) const {
  const auto mapper = mapper_series(system);
  const Json out = {
      {"unit", "ms"},
      {"per_frame", stages_to_json(stages_)},
      {"per_keyframe", stages_to_json(mapper)},
      {"series",
       {{"per_frame", series_to_json(stages_)}, {"per_keyframe", series_to_json(mapper)}}},
  };
  return out.dump(1) + "\n";
}

}  // namespace ydd
