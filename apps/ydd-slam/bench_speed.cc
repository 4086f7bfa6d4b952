// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench.h"
#include "run_job.h"
#include "ydd/base/files.h"
#include "ydd/base/timing.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Every run's timings and summary of one case.
Result<std::vector<RunOutcome>> run_case(const BenchCase& bench_case, const BenchRequest& request,
                                         const fs::path& scratch) {
  std::vector<RunOutcome> outcomes;
  for (int i = 0; i < request.runs; ++i) {
    RunRequest run;
    run.sequence = bench_case.folder.string();
    run.detections = bench_case.detections.string();
    run.set = request.set;
    run.out = (scratch / "run").string();
    run.quiet = true;
    Result<RunOutcome> outcome = run_sequence(run);
    if (!outcome) return outcome.error();
    outcomes.push_back(std::move(*outcome));
  }
  return outcomes;
}

/// Medians over runs of a stage's statistics over frames, processor time of the stage's thread.
std::string stage_rows(const std::string& name, const char* group,
                       const std::vector<Json>& timings) {
  std::string rows;
  for (const auto& [stage, unused] : timings.front().at(group).items()) {
    std::vector<double> median, p95, p99;
    for (const Json& t : timings) {
      if (!t.at(group).contains(stage)) continue;
      const Json& s = t.at(group).at(stage).at("cpu_ms");
      median.push_back(s.at("median"));
      p95.push_back(s.at("p95"));
      p99.push_back(s.at("p99"));
    }
    const SeriesStatistics m = statistics_of(median);
    rows += fmt::format("| {} | {} | {} | {:.3f} | {:.3f} - {:.3f} | {:.3f} | {:.3f} |\n", name,
                        group, stage, m.median, m.min, m.max, statistics_of(p95).median,
                        statistics_of(p99).median);
  }
  return rows;
}

}  // namespace

Result<std::string> bench_speed(const BenchRequest& request, const fs::path& scratch) {
  Result<std::vector<BenchCase>> cases = prepare_cases(request, scratch);
  if (!cases) return cases.error();
  std::string table =
      "| sequence | per | stage | CPU ms, median | over runs | p95 | p99 |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  Json json = Json::array();
  for (const BenchCase& bench_case : *cases) {
    const auto outcomes = run_case(bench_case, request, scratch);
    if (!outcomes) return outcomes.error();
    std::vector<Json> timings;
    for (const RunOutcome& outcome : *outcomes) {
      timings.push_back(Json::parse(outcome.timings_json));
      timings.back().erase("series");
      json.push_back({{"sequence", bench_case.name},
                      {"summary", Json::parse(outcome.summary_json)},
                      {"timings", timings.back()}});
    }
    table += stage_rows(bench_case.name, "per_frame", timings);
    table += stage_rows(bench_case.name, "per_keyframe", timings);
  }
  if (!request.out.empty()) {
    if (auto r = write_file_atomically(request.out, json.dump(2) + "\n"); !r) return r.error();
  }
  return table;
}

}  // namespace ydd::app
