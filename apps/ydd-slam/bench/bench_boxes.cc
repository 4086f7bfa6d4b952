// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/bench.h"
#include "bench/figures.h"
#include "ydd/base/timing.h"
#include "ydd/studies/faulty_boxes.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

/// The case with faulty boxes, written into `scratch`.
Result<BenchCase> faulty_case(const BenchCase& exact, BoxFault fault, const fs::path& scratch) {
  Result<DetectionRecording> recording = DetectionRecording::read(exact.detections);
  if (!recording) return recording.error();
  BenchCase out = exact;
  out.detections = scratch / "faulty.jsonl";
  const Result<void> written =
      write_recorded_detections(out.detections, with_fault(recording->frames(), fault));
  if (!written) return written.error();
  return out;
}

}  // namespace

Result<std::string> bench_boxes(const BenchRequest& request, const fs::path& scratch) {
  if (request.blind()) return Error{"bench boxes: needs boxes; leave out --detector none"};
  const Result<std::vector<BenchCase>> cases = prepare_cases(request, scratch);
  if (!cases) return cases.error();
  std::string table =
      "| sequence | boxes | ATE RMSE m, median | spread |\n"
      "| --- | --- | --- | --- |\n";
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const BenchCase& exact : *cases) {
    for (const BoxFault fault : kBoxFaults) {
      const Result<BenchCase> faulty = faulty_case(exact, fault, scratch);
      if (!faulty) return faulty.error();
      const Result<std::vector<double>> ate_m = ate_of_runs(*faulty, request, request.set, scratch);
      if (!ate_m) return ate_m.error();
      const SeriesStatistics s = statistics_of(*ate_m);
      table += fmt::format("| {} | {} | {:.4f} | {:.4f} - {:.4f} |\n", exact.name, to_string(fault),
                           s.median, s.min, s.max);
      json.push_back({{"sequence", exact.name},
                      {"boxes", std::string(to_string(fault))},
                      {"ate_rmse_m", *ate_m}});
    }
  }
  return table_and_json(std::move(table), json, request.out);
}

}  // namespace ydd::app
