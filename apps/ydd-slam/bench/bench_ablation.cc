// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/bench.h"
#include "bench/figures.h"
#include "common/default_detector.h"
#include "run/run_job.h"
#include "ydd/base/interruption.h"
#include "ydd/base/log.h"
#include "ydd/base/timing.h"
#include "ydd/evaluation/ate.h"
#include "ydd/evaluation/rpe.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Figures of several runs of one variant on one sequence.
struct Figures {
  std::vector<double> ate_m, rpe_m, rpe_deg, tracked_share;
};

Result<void> add_run(const BenchCase& bench_case, const std::string& variant,
                     const std::vector<std::string>& set, const fs::path& folder, Figures& out) {
  RunRequest request;
  request.sequence = bench_case.folder.string();
  request.detections = bench_case.detections.string();
  if (request.detections.empty()) request.detector = kNoDetector;
  request.dynamic = variant;
  request.set = set;
  request.out = folder.string();
  request.quiet = true;
  const Result<RunOutcome> run = run_whole_sequence(request);
  interruption::throw_if_asked();  // what was cut short is no figure
  if (!run) return run.error();
  if (!run->groundtruth_file) {
    return Error{fmt::format("{}: has no groundtruth.txt", request.sequence)};
  }
  const Result<StampedPoses> truth = read_tum_trajectory(*run->groundtruth_file);
  if (!truth) return truth.error();
  out.tracked_share.push_back(static_cast<double>(run->tracked) / run->processed);
  const Result<AteResult> ate = absolute_trajectory_error(*truth, run->trajectory);
  if (!ate) return {};  // tracked too little to score: shows in the share
  const RpeResult rpe = relative_pose_error(*truth, run->trajectory);
  out.ate_m.push_back(ate->statistics_m.rmse);
  out.rpe_m.push_back(rpe.translation_m.rmse);
  out.rpe_deg.push_back(rpe.rotation_deg.rmse);
  return {};
}

Json to_json(const std::vector<double>& values) {
  const SeriesStatistics s = statistics_of(values);
  return {{"median", s.median}, {"min", s.min}, {"max", s.max}, {"runs", values}};
}

std::string table_row(const std::string& name, const std::string& variant, const Figures& f) {
  const SeriesStatistics ate = statistics_of(f.ate_m);
  return fmt::format("| {} | {} | {:.4f} | {:.4f} - {:.4f} | {:.4f} | {:.3f} | {:.0f} % |\n", name,
                     variant, ate.median, ate.min, ate.max, statistics_of(f.rpe_m).median,
                     statistics_of(f.rpe_deg).median,
                     100.0 * statistics_of(f.tracked_share).median);
}

}  // namespace

Result<std::string> bench_ablation(const BenchRequest& request, const fs::path& scratch) {
  const Result<std::vector<BenchCase>> cases = prepare_cases(request, scratch);
  if (!cases) return cases.error();
  std::string table =
      "| sequence | variant | ATE RMSE m, median | spread | RPE m/s | RPE deg/s | tracked |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  Json json = Json::array();
  const std::vector<Variant> variants = variants_of(
      request, {Variant::off, Variant::box, Variant::person, Variant::full, Variant::evidence});
  for (const BenchCase& bench_case : *cases) {
    for (const Variant choice : variants) {
      const std::string variant(to_string(choice));
      Figures figures;
      for (int run = 0; run < request.runs; ++run) {
        if (auto r = add_run(bench_case, variant, request.set, scratch / "run", figures); !r) {
          return r.error();
        }
      }
      table += table_row(bench_case.name, variant, figures);
      json.push_back({{"sequence", bench_case.name},
                      {"variant", variant},
                      {"ate_rmse_m", to_json(figures.ate_m)},
                      {"rpe_rmse_m", to_json(figures.rpe_m)},
                      {"rpe_rmse_deg", to_json(figures.rpe_deg)},
                      {"tracked_share", to_json(figures.tracked_share)}});
    }
  }
  return table_and_json(std::move(table), json, request.out);
}

}  // namespace ydd::app
