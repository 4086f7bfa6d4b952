// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <memory>

#include <fmt/format.h>

#include "bench.h"
#include "commands.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

using Bench = Result<std::string> (*)(const BenchRequest&, const fs::path&);

/// Runs a bench with a scratch folder that goes afterwards.
Result<void> run_bench(Bench bench, const BenchRequest& request) {
  const fs::path scratch = fs::temp_directory_path() / fmt::format("ydd-slam-bench-{}", ::getpid());
  std::error_code error;
  fs::create_directories(scratch, error);
  if (error) return Error{fmt::format("{}: cannot be created", scratch.string())};
  Result<std::string> table = bench(request, scratch);
  fs::remove_all(scratch, error);
  if (!table) return table.error();
  fmt::print("{}", *table);
  return {};
}

void add_bench(CLI::App& parent, Job& job, const std::string& name, const std::string& what,
               Bench bench, bool boxes_needed) {
  auto request = std::make_shared<BenchRequest>();
  request->boxes_needed = boxes_needed;
  auto* command = parent.add_subcommand(name, what);
  command->add_option("sequences", request->sequences, "Folders in the TUM RGB-D layout");
  command->add_option("--simulated", request->simulated, "Also so many simulated busy rooms");
  command->add_option("--simulated-frames", request->simulated_frames, "Length of these");
  command->add_option("--detector", request->detector,
                      "Detector YAML; default: boxes recorded beside the sequence "
                      "(detections.jsonl, detections_gt.jsonl)");
  command->add_option("--runs", request->runs, "Runs per figure (the median is given)")
      ->check(CLI::Range(1, 100));
  command->add_option("--set", request->set, "Set one option: key=value")->allow_extra_args(false);
  command->add_option("--out", request->out, "Also write all figures as JSON");
  command->callback([request, bench, &job] {
    job = [request, bench]() -> Result<void> {
      if (request->sequences.empty() && request->simulated == 0) {
        return Error{"bench: name a sequence or give --simulated N"};
      }
      return run_bench(bench, *request);
    };
  });
}

}  // namespace

void add_bench_command(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("bench", "Measure accuracy, point decisions and speed");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n"
      "  ydd-slam bench ablation samples/office_crowd --simulated 3\n"
      "  ydd-slam bench dynamics samples/office_crowd\n"
      "  ydd-slam bench speed rgbd_dataset_freiburg1_xyz");
  add_bench(*command, job, "ablation", "ATE and RPE of the variants off, box, person, full",
            &bench_ablation, true);
  add_bench(*command, job, "dynamics", "Recall and precision of rejected points per variant",
            &bench_dynamics, true);
  add_bench(*command, job, "speed", "Time per frame and stage", &bench_speed, false);
}

}  // namespace ydd::app
