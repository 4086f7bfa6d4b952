// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/bench.h"
#include "bench/figures.h"

namespace ydd::app {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Result<PointDecisions> judge_sequence(const BenchCase& bench_case, Variant variant,
                                      const std::vector<std::string>& set, int latency_frames) {
  Result<SystemOptions> options = system_options(set);
  if (!options) return options.error();
  options->dynamics.variant = variant;
  return decide_points(bench_case.folder, bench_case.detections, *options, latency_frames);
}

Result<std::string> bench_dynamics(const BenchRequest& request, const fs::path& scratch) {
  const Result<std::vector<BenchCase>> cases = prepare_cases(request, scratch);
  if (!cases) return cases.error();
  std::string table =
      "| sequence | variant | recall of moving points | precision | static points in person boxes "
      "kept | the same off silhouettes | decision ms, median | extraction ms |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  Json json = Json::array();
  const std::vector<Variant> variants =
      variants_of(request, {Variant::box, Variant::person, Variant::full, Variant::evidence});
  for (const BenchCase& bench_case : *cases) {
    for (const Variant variant : variants) {
      const Result<PointDecisions> result = judge_sequence(bench_case, variant, request.set, 0);
      if (!result) return result.error();
      const PointQuality& q = result->quality;
      const double judge_ms = statistics_of(result->judge_ms).median;
      const double extract_ms = statistics_of(result->extract_ms).median;
      table += fmt::format(
          "| {} | {} | {:.1f} % | {:.1f} % | {:.1f} % | {:.1f} % | {:.3f} | {:.2f} |\n",
          bench_case.name, to_string(variant), 100 * q.recall(), 100 * q.precision(),
          100 * q.kept_in_persons(), 100 * q.kept_off_silhouettes(), judge_ms, extract_ms);
      json.push_back({{"sequence", bench_case.name},
                      {"variant", std::string(to_string(variant))},
                      {"recall", q.recall()},
                      {"precision", q.precision()},
                      {"kept_in_persons", q.kept_in_persons()},
                      {"kept_off_silhouettes", q.kept_off_silhouettes()},
                      {"decision_ms", judge_ms},
                      {"extraction_ms", extract_ms}});
    }
  }
  return table_and_json(std::move(table), json, request.out);
}

}  // namespace ydd::app
