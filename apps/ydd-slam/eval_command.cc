// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "commands.h"
#include "run/run_report.h"
#include "ydd/base/log.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/evaluation/report.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

struct EvalArguments {
  std::string groundtruth;
  std::string trajectory;
  bool json = false;
  bool scale = false;
  double max_difference_s = 0.02;
  double rpe_delta = 1.0;
  std::string rpe_unit = "s";
  bool rpe_benchmark = false;
};

EvaluationOptions options_of(const EvalArguments& arguments) {
  EvaluationOptions options;
  options.ate.max_difference_s = arguments.max_difference_s;
  options.ate.scale = arguments.scale ? AlignmentScale::estimated : AlignmentScale::fixed;
  options.rpe.delta = arguments.rpe_delta;
  options.rpe.max_difference_s = arguments.max_difference_s;
  options.rpe.benchmark_matching = arguments.rpe_benchmark;
  options.rpe.unit = arguments.rpe_unit == "frames" ? RpeUnit::frames : RpeUnit::seconds;
  return options;
}

/// The report beside a run's trajectory, with these figures. What was asked for is the score: a
/// folder that cannot be written to costs a warning.
void renew_report(const EvalArguments& arguments, const StampedPoses& groundtruth,
                  const StampedPoses& trajectory, const Evaluation& evaluation) {
  const fs::path file = arguments.trajectory;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (file.filename() != "trajectory.tum" || !is_run_folder(folder)) return;
  RunReportData data = read_run(folder);
  data.trajectory = trajectory;
  data.groundtruth = groundtruth;
  data.evaluation = evaluation;
  if (auto r = write_run_report(data, folder / "report.html"); !r) {
    log::warning("{}; the report stays as it was", r.error().message);
  }
}

Result<void> run_eval(const EvalArguments& arguments) {
  const Result<StampedPoses> groundtruth = read_tum_trajectory(arguments.groundtruth);
  if (!groundtruth) return groundtruth.error();
  const Result<StampedPoses> trajectory = read_tum_trajectory(arguments.trajectory);
  if (!trajectory) return trajectory.error();
  const Result<Evaluation> evaluation = evaluate(*groundtruth, *trajectory, options_of(arguments));
  if (!evaluation) {
    return Error{fmt::format("{}: {}", arguments.trajectory, evaluation.error().message)};
  }
  fmt::print("{}", arguments.json ? format_json(*evaluation) : format_table(*evaluation));
  renew_report(arguments, *groundtruth, *trajectory, *evaluation);
  return {};
}

}  // namespace

void add_eval_command(CLI::App& app, Job& job) {
  const auto arguments = std::make_shared<EvalArguments>();
  auto* command =
      app.add_subcommand("eval", "Score a trajectory against ground truth: ATE and RPE");
  command->add_option("groundtruth", arguments->groundtruth, "True poses (TUM format)")->required();
  command->add_option("trajectory", arguments->trajectory, "Estimated poses (TUM format)")
      ->required();
  command->add_flag("--json", arguments->json, "JSON at full precision instead of a table");
  command->add_flag("--scale", arguments->scale, "Align by Sim(3), for maps without metric scale");
  command
      ->add_option("--max-difference", arguments->max_difference_s,
                   "Poses farther apart in time are no pair, seconds")
      ->check(CLI::Range(1e-6, 10.0))
      ->capture_default_str();
  command->add_option("--rpe-delta", arguments->rpe_delta, "Interval of the relative error")
      ->check(CLI::Range(1e-3, 1e6))
      ->capture_default_str();
  command->add_option("--rpe-unit", arguments->rpe_unit, "Unit of the interval")
      ->check(CLI::IsMember({"s", "frames"}))
      ->capture_default_str();
  command->add_flag("--rpe-benchmark-matching", arguments->rpe_benchmark,
                    "Pair poses and truth for the RPE as TUM's script does, whatever "
                    "--max-difference says");
  command->footer(
      "Examples:\n"
      "  ydd-slam eval fr1_xyz/groundtruth.txt runs/latest/trajectory.tum\n"
      "  ydd-slam eval groundtruth.txt trajectory.tum --json --rpe-delta 1 --rpe-unit frames\n"
      "In the folder of a run this also renews report.html.");
  command->callback([arguments, &job] {
    const bool whole = arguments->rpe_delta == std::floor(arguments->rpe_delta);
    if (arguments->rpe_unit == "frames" && !whole) {
      throw CLI::ValidationError("--rpe-delta", "must be a whole number of frames");
    }
    if (!std::isfinite(arguments->max_difference_s) || !std::isfinite(arguments->rpe_delta)) {
      throw CLI::ValidationError("--max-difference, --rpe-delta", "must be numbers");
    }
    job = [arguments] { return run_eval(*arguments); };
  });
}

}  // namespace ydd::app
