// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/bench.h"
#include "bench/figures.h"
#include "run/run_job.h"
#include "ydd/base/interruption.h"
#include "ydd/base/timing.h"
#include "ydd/evaluation/ate.h"
#include "ydd/system/system_options.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Row {
  int latency_frames = 0;
  std::vector<double> ate_m;
  std::optional<PointQuality> points;  ///< of a sequence with masks
};

Result<Row> measure(const BenchCase& bench_case, const BenchRequest& request, int latency,
                    const fs::path& scratch) {
  Row row;
  row.latency_frames = latency;
  std::vector<std::string> set = request.set;
  if (latency > 0) {
    set.emplace_back("detect.mode=asynchronous");
    set.push_back(fmt::format("detect.latency_frames={}", latency));
  }
  Result<std::vector<double>> ate = ate_of_runs(bench_case, request, set, scratch);
  if (!ate) return ate.error();
  row.ate_m = std::move(*ate);
  if (!fs::is_directory(bench_case.folder / "mask")) return row;
  const Result<SystemOptions> options = system_options(request.set);
  if (!options) return options.error();
  const Result<PointDecisions> judged =
      judge_sequence(bench_case, options->dynamics.variant, request.set, latency);
  if (!judged) return judged.error();
  row.points = judged->quality;
  return row;
}

std::string text_of(const Row& row, const std::string& name) {
  const SeriesStatistics ate = statistics_of(row.ate_m);
  const std::string boxes =
      row.latency_frames == 0 ? "every frame" : fmt::format("{} frames late", row.latency_frames);
  const std::string points = row.points
                                 ? fmt::format("{:.1f} % | {:.1f} %", 100 * row.points->recall(),
                                               100 * row.points->precision())
                                 : "- | -";
  return fmt::format("| {} | {} | {:.4f} | {:.4f} - {:.4f} | {} |\n", name, boxes, ate.median,
                     ate.min, ate.max, points);
}

Json json_of(const Row& row, const std::string& name) {
  Json json = {
      {"sequence", name}, {"latency_frames", row.latency_frames}, {"ate_rmse_m", row.ate_m}};
  if (row.points) {
    json["recall"] = row.points->recall();
    json["precision"] = row.points->precision();
  }
  return json;
}

}  // namespace

Result<std::vector<double>> ate_of_runs(const BenchCase& bench_case, const BenchRequest& request,
                                        const std::vector<std::string>& set,
                                        const fs::path& scratch) {
  std::vector<double> values;
  for (int i = 0; i < request.runs; ++i) {
    RunRequest run;
    run.sequence = bench_case.folder.string();
    run.detections = bench_case.detections.string();
    run.set = set;
    run.out = (scratch / "run").string();
    run.quiet = true;
    const Result<RunOutcome> outcome = run_whole_sequence(run);
    interruption::throw_if_asked();  // what was cut short is no figure
    if (!outcome) return outcome.error();
    if (!outcome->groundtruth_file) {
      return Error{fmt::format("{}: has no groundtruth.txt", run.sequence)};
    }
    const Result<StampedPoses> truth = read_tum_trajectory(*outcome->groundtruth_file);
    if (!truth) return truth.error();
    const Result<AteResult> ate = absolute_trajectory_error(*truth, outcome->trajectory);
    if (ate) values.push_back(ate->statistics_m.rmse);
  }
  return values;
}

Result<std::string> bench_detection(const BenchRequest& request, const fs::path& scratch) {
  if (request.blind()) return Error{"bench detection: needs boxes; leave out --detector none"};
  const Result<std::vector<BenchCase>> cases = prepare_cases(request, scratch);
  if (!cases) return cases.error();
  std::string table =
      "| sequence | boxes | ATE RMSE m, median | spread | recall of moving points | precision |\n"
      "| --- | --- | --- | --- | --- | --- |\n";
  Json json = Json::array();
  for (const BenchCase& bench_case : *cases) {
    for (const int latency : {0, 1, 2, 4, 8}) {
      const Result<Row> row = measure(bench_case, request, latency, scratch);
      if (!row) return row.error();
      table += text_of(*row, bench_case.name);
      json.push_back(json_of(*row, bench_case.name));
    }
  }
  return table_and_json(std::move(table), json, request.out);
}

}  // namespace ydd::app
