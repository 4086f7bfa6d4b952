// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "commands.h"
#include "run_report.h"
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
};

EvaluationOptions options_of(const EvalArguments& arguments) {
  EvaluationOptions options;
  options.ate.max_difference_s = arguments.max_difference_s;
  options.ate.scale = arguments.scale ? AlignmentScale::estimated : AlignmentScale::fixed;
  options.rpe.delta = arguments.rpe_delta;
  options.rpe.unit = arguments.rpe_unit == "frames" ? RpeUnit::frames : RpeUnit::seconds;
  return options;
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
  if (const fs::path folder = fs::path(arguments.trajectory).parent_path(); is_run_folder(folder)) {
    if (auto r = write_run_report(folder, *trajectory, *groundtruth, *evaluation); !r) return r;
  }
  fmt::print("{}", arguments.json ? format_json(*evaluation) : format_table(*evaluation));
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
  command->footer(
      "Examples:\n"
      "  ydd-slam eval fr1_xyz/groundtruth.txt runs/latest/trajectory.tum\n"
      "  ydd-slam eval groundtruth.txt trajectory.tum --json --rpe-delta 1 --rpe-unit frames");
  command->callback([arguments, &job] {
    const bool whole = arguments->rpe_delta == std::floor(arguments->rpe_delta);
    if (arguments->rpe_unit == "frames" && !whole) {
      throw CLI::ValidationError("--rpe-delta", "must be a whole number of frames");
    }
    job = [arguments] { return run_eval(*arguments); };
  });
}

}  // namespace ydd::app
