// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include "bench/bench.h"
#include "bench/energy.h"
#include "bench/figures.h"
#include "common/child_run.h"
#include "common/default_detector.h"
#include "ydd/base/log.h"
#include "ydd/base/timing.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/sources/source.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// One configuration on one sequence at one pace, run several times.
struct Series {
  std::vector<ChildRun> runs;
  std::vector<double> joules;  ///< empty where the machine does not tell
};

/// How a sequence is fed, and which options are compared.
struct Setup {
  bool realtime = false;
  std::vector<std::string> set;
};

Result<void> add_run(const BenchCase& bench_case, const BenchRequest& request, const Setup& setup,
                     const fs::path& scratch, Series& series) {
  std::vector<std::string> arguments{bench_case.folder.string()};
  const auto option = [&](const char* name, const std::string& value) {
    arguments.insert(arguments.end(), {name, value});
  };
  if (!request.detector.empty()) {
    option("--detector", request.detector);
    for (const std::string& assignment : request.detector_set) {
      option("--detector-set", assignment);
    }
  } else if (!bench_case.detections.empty()) {
    option("--detections", bench_case.detections.string());
  } else {
    option("--detector", kNoDetector);
  }
  if (!request.detect.empty()) option("--detect", request.detect);
  if (setup.realtime) arguments.emplace_back("--realtime");
  for (const std::string& assignment : setup.set) option("--set", assignment);
  const EnergyMeter meter;
  Result<ChildRun> run = run_in_child(std::move(arguments), scratch / "run");
  if (!run) return run.error();
  if (const auto joules = meter.joules()) series.joules.push_back(*joules);
  series.runs.push_back(std::move(*run));
  return {};
}

/// Median over runs of what `figure` says of each.
template <class Figure>
SeriesStatistics over_runs(const Series& series, Figure figure) {
  std::vector<double> values;
  for (const ChildRun& run : series.runs) values.push_back(figure(run));
  return statistics_of(std::move(values));
}

/// A statistic of a stage: "cpu_ms" or "wall_ms", "median", "p95", ...; 0 where it did not run.
double stage_figure(const ChildRun& run, const char* group, const std::string& stage,
                    const char* clock, const char* what) {
  const Json& stages = run.timings.at(group);
  return stages.contains(stage) ? stages.at(stage).at(clock).at(what).get<double>() : 0.0;
}

/// Frames that took longer than the camera's interval.
double late_frames(const ChildRun& run, double fps) {
  const Json& walls = run.timings.at("series").at("per_frame").at("total");
  const Json& wall_ms = walls.is_array() ? walls : walls.at("wall_ms");
  return static_cast<double>(std::count_if(wall_ms.begin(), wall_ms.end(), [&](const Json& ms) {
    return ms.get<double>() > 1000.0 / fps;
  }));
}

std::string stage_rows(const std::string& name, const char* group, const Series& series,
                       double fps) {
  std::string rows;
  for (const auto& [stage, unused] : series.runs.front().timings.at(group).items()) {
    const auto figure = [&, stage = stage](const char* clock, const char* what) {
      return over_runs(
          series, [&](const ChildRun& r) { return stage_figure(r, group, stage, clock, what); });
    };
    const SeriesStatistics median = figure("cpu_ms", "median");
    const bool per_frame = std::string_view(group) == "per_frame";
    const double share = 0.1 * fps * figure("cpu_ms", "mean").median;  // of a core, per cent
    rows +=
        fmt::format("| {} | {} | {} | {:.3f} | {:.3f} - {:.3f} | {:.3f} | {:.3f} | {:.3f} | {} |\n",
                    name, per_frame ? "frame" : "keyframe", stage, median.median, median.min,
                    median.max, figure("cpu_ms", "p95").median, figure("cpu_ms", "p99").median,
                    figure("wall_ms", "p99").median,
                    per_frame ? fmt::format("{:.1f} %", share) : std::string());
  }
  return rows;
}

std::string run_row(const std::string& name, const Series& series, double fps) {
  const auto count = [&](const char* key) {
    return over_runs(series, [&](const ChildRun& r) { return r.summary.at(key).get<double>(); });
  };
  const auto wall = [&](const char* stage, const char* what) {
    return over_runs(series,
                     [&](const ChildRun& r) {
                       return stage_figure(r, "per_frame", stage, "wall_ms", what);
                     })
        .median;
  };
  const SeriesStatistics late =
      over_runs(series, [&](const ChildRun& r) { return late_frames(r, fps); });
  const std::string joules = series.joules.empty()
                                 ? std::string("not told")
                                 : fmt::format("{:.1f}", statistics_of(series.joules).median);
  return fmt::format(
      "| {} | {:.0f} | {:.0f} | {:.0f} ({:.0f}) | {:.0f} | {:.1f} | {:.2f} | {:.2f} | {:.1f} / "
      "{:.1f} | {:.0f} | {} |\n",
      name, count("frames_in").median, count("frames_processed").median,
      count("frames_dropped").median, count("frames_dropped").max, late.median,
      count("frames_per_second").median, wall("total", "median"), wall("total", "p99"),
      wall("detect", "median"), wall("detect", "p99"), count("peak_resident_mb").median, joules);
}

/// Ratios of pairs run one after the other: what the machine does meanwhile cancels out.
std::string ratio_row(const std::string& name, const Series& a, const Series& b) {
  std::string row = fmt::format("| {} |", name);
  for (const char* what : {"median", "p99"}) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < a.runs.size(); ++i) {
      ratios.push_back(stage_figure(b.runs[i], "per_frame", "total", "cpu_ms", what) /
                       stage_figure(a.runs[i], "per_frame", "total", "cpu_ms", what));
    }
    const SeriesStatistics s = statistics_of(ratios);
    row += fmt::format(" {:.3f} ({:.3f} - {:.3f}) |", s.median, s.min, s.max);
  }
  return row + "\n";
}

Json to_json(const std::string& name, const char* pace, const char* configuration,
             const Series& series) {
  Json runs = Json::array();
  for (const ChildRun& run : series.runs) {
    Json timings = run.timings;
    timings.erase("series");
    runs.push_back({{"summary", run.summary}, {"timings", timings}});
  }
  return {{"sequence", name},
          {"pace", pace},
          {"configuration", configuration},
          {"joules", series.joules},
          {"runs", runs}};
}

struct Tables {
  std::string runs =
      "| sequence, pace | frames in | processed | dropped (worst) | late | fps | frame ms, median "
      "| p99 | detector ms, median / p99 | peak MB | joules |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  std::string stages =
      "| sequence, pace | per | stage | CPU ms, median | over runs | p95 | p99 | wall p99 | share "
      "of a core |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  std::string ratios =
      "| sequence, pace | tracking CPU, B / A: median (spread) | p99 (spread) |\n"
      "| --- | --- | --- |\n";
};

Result<void> measure(const BenchCase& bench_case, const BenchRequest& request, bool realtime,
                     const fs::path& scratch, Tables& tables, Json& json) {
  const Result<Recording> recording = open_recording(bench_case.folder);
  if (!recording) return recording.error();
  const Result<Camera> camera = find_camera(*recording);
  if (!camera) return camera.error();
  const char* pace = realtime ? "real time" : "flat out";
  const std::string name = fmt::format("{}, {}", bench_case.name, pace);
  Setup a{realtime, request.set};
  Setup b = a;
  b.set.insert(b.set.end(), request.against.begin(), request.against.end());
  Series of_a, of_b;
  for (int i = 0; i < request.runs; ++i) {
    log::info("{}: run {} of {}", name, i + 1, request.runs);
    if (auto r = add_run(bench_case, request, a, scratch, of_a); !r) return r;
    if (request.against.empty()) continue;
    if (auto r = add_run(bench_case, request, b, scratch, of_b); !r) return r;
  }
  tables.runs += run_row(name, of_a, camera->fps);
  tables.stages += stage_rows(name, "per_frame", of_a, camera->fps) +
                   stage_rows(name, "per_keyframe", of_a, camera->fps);
  json.push_back(to_json(bench_case.name, pace, "A", of_a));
  if (request.against.empty()) return {};
  tables.runs += run_row(name + ", B", of_b, camera->fps);
  tables.ratios += ratio_row(name, of_a, of_b);
  json.push_back(to_json(bench_case.name, pace, "B", of_b));
  return {};
}

}  // namespace

Result<std::string> bench_speed(const BenchRequest& request, const fs::path& scratch) {
  BenchRequest cases_request = request;
  cases_request.detector.clear();  // it is to run with the tracker, not before
  Result<std::vector<BenchCase>> cases = prepare_cases(cases_request, scratch);
  if (!cases) return cases.error();
  Tables tables;
  Json json = {{"machine", machine_description()},
               {"set", request.set},
               {"against", request.against},
               {"detector", fs::path(request.detector).filename().string()},
               {"detector_set", request.detector_set},
               {"detect", request.detect},
               {"series", Json::array()}};
  for (const BenchCase& bench_case : *cases) {
    for (const bool realtime : {false, true}) {
      if (auto r = measure(bench_case, request, realtime, scratch, tables, json["series"]); !r) {
        return r.error();
      }
    }
  }
  std::string text = tables.runs + "\n" + tables.stages;
  if (!request.against.empty()) text += "\n" + tables.ratios;
  return table_and_json(std::move(text), json, request.out);
}

}  // namespace ydd::app
