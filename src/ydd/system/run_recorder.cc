// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/run_recorder.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "ydd/base/json_text.h"
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
Json medians_to_json(const std::map<std::string, Series>& stages) {
  Json out = Json::object();
  for (const auto& [stage, series] : stages) out[stage] = statistics_of(series.cpu_ms).median;
  return out;
}

template <class Series>
Json series_to_json(const std::map<std::string, Series>& stages) {
  Json out = Json::object();
  for (const auto& [stage, series] : stages) out[stage] = series.wall_ms;
  return out;
}

/// Microseconds are fine enough.
double rounded(double value) { return std::round(value * 1e3) / 1e3; }

/// One entry per item.
template <class Items, class Get>
Json column(const Items& items, Get get) {
  Json out = Json::array();
  for (const auto& item : items) out.push_back(get(item));
  return out;
}

const StageTime* find_stage(const StageTimes& times, const std::string& stage) {
  const auto it = std::find_if(times.begin(), times.end(),
                               [&](const StageTime& time) { return time.stage == stage; });
  return it == times.end() ? nullptr : &*it;
}

Json loops_to_json(const std::vector<LoopReport>& loops) {
  Json out = Json::array();
  for (const LoopReport& loop : loops) {
    out.push_back({{"frame", loop.current_frame},
                   {"matched_frame", loop.matched_frame},
                   {"points", loop.inliers},
                   {"shift_m", loop.shift_m},
                   {"merged_maps", loop.merged}});
  }
  return out;
}

/// What an image list had, and what found a partner.
Json to_json(const Pairing& pairing) {
  return {{"colour_images", pairing.colour_images},
          {"depth_images", pairing.depth_images},
          {"pairs", pairing.pairs},
          {"depth_offset_s", pairing.depth_offset_s},
          {"depth_later_s", pairing.depth_later_s}};
}

Json to_json(const LiveCounts& counts) {
  return {{"arrived", counts.arrived},
          {"dropped", counts.dropped},
          {"unpaired", counts.unpaired},
          {"pauses", counts.pauses},
          {"unplugged", counts.unplugged}};
}

template <class Span>
Json spans_to_json(const std::vector<Span>& spans) {
  Json out = Json::array();
  for (const Span& span : spans) out.push_back({{"first", span.first}, {"last", span.last}});
  return out;
}

Json to_json(const LoopCounts& counts) {
  return {{"keyframes_left_out", counts.keyframes_left_out},
          {"full_bundles", counts.full_bundles},
          {"full_bundles_merged", counts.full_bundles_merged},
          {"full_bundles_begun_anew", counts.full_bundles_begun_anew},
          {"corrections_rebased", counts.rebased},
          {"corrections_refused", counts.refused},
          {"interrupted", counts.interrupted}};
}

}  // namespace

double peak_resident_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void RunRecorder::add(const FrameReport& report, const MapSize& map) {
  ++processed_;
  if (report.keyframe) ++keyframes_;
  if (report.track.state == TrackingState::coasting) ++doubts_[report.track.doubt];
  if (report.track.state == TrackingState::tracking || report.track.reference.valid()) {
    ++tracked_;
  } else if (!lost_.empty() && lost_.back().last + 1 == report.index) {
    lost_.back().last = report.index;
  } else {
    lost_.push_back({report.index, report.index});
  }
  requested_.push_back(report.requested);
  kept_.push_back(static_cast<double>(report.filtered->kept->size()));
  const auto rules = count_rules(*report.filtered);
  for (std::size_t i = 0; i < rules.size(); ++i) rules_[i] += rules[i];
  for (const StageTime& t : report.times) {
    stages_[t.stage].wall_ms.push_back(t.wall_ms);
    stages_[t.stage].cpu_ms.push_back(t.cpu_ms);
  }
  frames_.push_back({report.index, report.stamp, report.track.state, report.keyframe,
                     report.requested, report.track.inliers, report.track.agreement,
                     report.filtered->kept->size(), rules, count_objects(report.judgement), map,
                     report.times});
}

RunRecorder::Objects RunRecorder::count_objects(const Judgement& judgement) {
  Objects objects;
  for (const ObjectJudgement& object : judgement.objects) {
    if (object.log_odds) ++(object.rule == Rule::kept ? objects.still : objects.moving);
  }
  return objects;
}

void RunRecorder::add_skipped(std::int64_t frame, const std::string& reason) {
  skipped_.emplace_back(frame, reason);
}

void RunRecorder::add_camera(const LiveCounts& counts) {
  camera_ = counts;
  add_dropped(static_cast<int>(counts.dropped));
}

void RunRecorder::add_command(std::int64_t after_frame, const std::string& command) {
  commands_.emplace_back(after_frame, command);
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
  add(system.save_times());
  return stages;
}

std::string RunRecorder::summary_json(const RunDescription& run, const SlamSystem& system,
                                      double wall_seconds) const {
  const auto atlas = system.atlas();
  const MappingReports reports = system.mapping_reports();
  Json skipped = Json::array();
  for (const auto& [frame, reason] : skipped_) {
    skipped.push_back({{"frame", frame}, {"reason", reason}});
  }
  Json rejected = Json::object();
  for (std::size_t i = 1; i < rules_.size(); ++i) {
    rejected[std::string(to_string(static_cast<Rule>(i)))] = rules_[i];
  }
  Json commands = Json::array();
  for (const auto& [frame, command] : commands_) {
    commands.push_back({{"after_frame", frame}, {"command", command}});
  }
  const Json out = {
      {"version", kVersion},
      {"sequence", run.sequence},
      {"complete", run.incomplete.empty()},
      {"incomplete", run.incomplete},
      {"variant", run.variant},
      {"detector", run.detector},
      {"detector_device", run.device},
      {"deterministic", run.deterministic},
      {"realtime", run.realtime},
      {"seed", run.seed},
      {"groundtruth", run.groundtruth},
      {"versions", run.versions},
      {"pictures", run.pairing ? to_json(*run.pairing) : Json()},
      {"camera", camera_ ? to_json(*camera_) : Json()},
      {"depth_shift_px", {run.depth_shift.right_px, run.depth_shift.down_px}},
      {"frames_in", frames_in()},
      {"frames_processed", processed_},
      {"frames_dropped", dropped_},
      {"frames_skipped", skipped},
      {"frames_tracked", tracked_},
      {"frames_coasting", doubts_},
      {"lost_spans", spans_to_json(lost_)},
      {"loops", loops_to_json(reports.loops)},
      {"loop_closing", to_json(reports.loop_counts)},
      {"live_commands", commands},
      {"keyframes_inserted", keyframes_},
      {"keyframes_kept", atlas->keyframes().size()},
      {"map_points", atlas->points().size()},
      {"features_requested", to_json(statistics_of(requested_))},
      {"features_kept", to_json(statistics_of(kept_))},
      {"features_rejected_by_rule", rejected},
      {"wall_seconds", wall_seconds},
      {"frames_per_second", wall_seconds > 0 ? processed_ / wall_seconds : 0.0},
      {"peak_resident_mb", peak_resident_mb()},
      {"stage_median_cpu_ms", medians_to_json(stages_)},
  };
  return json_text(out, 2) + "\n";
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
  return json_text(out, 1) + "\n";
}

std::string RunRecorder::frames_json() const {
  const auto list = [&](auto get) { return column(frames_, get); };
  const auto stage = [&](const std::string& name, double StageTime::*clock) {
    return list([&](const Frame& f) {
      const StageTime* const time = find_stage(f.times, name);
      return time ? Json(rounded(time->*clock)) : Json();
    });
  };
  Json rejected = Json::object();
  for (std::size_t i = 1; i < rules_.size(); ++i) {
    rejected[std::string(to_string(static_cast<Rule>(i)))] =
        list([i](const Frame& f) { return f.rules[i]; });
  }
  Json stages = Json::object();
  for (const auto& [name, series] : stages_) stages[name] = stage(name, &StageTime::cpu_ms);
  const Json out = {
      {"index", list([](const Frame& f) { return f.index; })},
      {"stamp_s", list([](const Frame& f) { return f.stamp.seconds(); })},
      {"state", list([](const Frame& f) { return std::string(to_string(f.state)); })},
      {"keyframe", list([](const Frame& f) { return f.keyframe; })},
      {"requested", list([](const Frame& f) { return f.requested; })},
      {"kept", list([](const Frame& f) { return f.kept; })},
      {"inliers", list([](const Frame& f) { return f.inliers; })},
      {"agreement", list([](const Frame& f) { return rounded(f.agreement); })},
      {"rejected", rejected},
      {"objects_moving", list([](const Frame& f) { return f.objects.moving; })},
      {"objects_still", list([](const Frame& f) { return f.objects.still; })},
      {"keyframes", list([](const Frame& f) { return f.map.keyframes; })},
      {"points", list([](const Frame& f) { return f.map.points; })},
      {"total_wall_ms", stage("total", &StageTime::wall_ms)},
      {"stages_cpu_ms", stages},
  };
  return json_text(out) + "\n";
}

}  // namespace ydd
