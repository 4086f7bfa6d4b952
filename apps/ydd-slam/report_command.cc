// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "commands.h"
#include "run/run_report.h"
#include "ydd/base/files.h"
#include "ydd/base/log.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::vector<std::string> runs;
  std::vector<std::string> trajectories;  ///< NAME=FILE
  std::string groundtruth;
  std::string out;
};

std::string name_of(const fs::path& run) {
  // runs/latest is worth the name it points at.
  std::error_code error;
  const fs::path real = fs::canonical(run, error);
  return error ? run.filename().string() : real.filename().string();
}

Result<RunReportData> load_run(const fs::path& folder) {
  if (!is_run_folder(folder)) {
    return Error{
        fmt::format("{}: not the folder of a run (no summary.json); a single trajectory "
                    "is given as --trajectory NAME=FILE",
                    folder.string())};
  }
  Result<StampedPoses> trajectory = read_tum_trajectory(folder / "trajectory.tum");
  if (!trajectory) return trajectory.error();
  RunReportData run = read_run(folder);
  run.trajectory = *std::move(trajectory);
  return run;
}

Result<RunReportData> load_trajectory(const std::string& assignment) {
  const auto at = assignment.find('=');
  if (at == 0 || at == std::string::npos || at + 1 == assignment.size()) {
    return Error{fmt::format("--trajectory {}: must be NAME=FILE", assignment)};
  }
  Result<StampedPoses> trajectory = read_tum_trajectory(assignment.substr(at + 1));
  if (!trajectory) return trajectory.error();
  RunReportData data;
  data.title = assignment.substr(0, at);
  data.trajectory = *std::move(trajectory);
  return data;
}

/// Figures of different sequences compare to nothing.
Result<void> check_one_sequence(const ReportArguments& arguments,
                                const std::vector<RunReportData>& runs) {
  for (std::size_t i = 1; i < runs.size(); ++i) {
    if (sequence_of(runs[i]) == sequence_of(runs[0])) continue;
    return Error{fmt::format("{}: a run on {}, but {} is one on {}; give runs on one sequence",
                             arguments.runs[i], sequence_of(runs[i]), arguments.runs[0],
                             sequence_of(runs[0]))};
  }
  return {};
}

/// The file that the user names, else the one that the runs name.
std::optional<fs::path> groundtruth_file(const ReportArguments& arguments,
                                         const std::vector<RunReportData>& runs) {
  if (!arguments.groundtruth.empty()) return arguments.groundtruth;
  for (const RunReportData& run : runs) {
    auto file = groundtruth_file_of(run);
    if (!file) continue;
    if (fs::is_regular_file(*file)) return file;
    log::warning("{}: not there any more; name ground truth with --groundtruth", file->string());
    return std::nullopt;
  }
  return std::nullopt;
}

Result<void> report_one(const ReportArguments& arguments, RunReportData run) {
  if (const auto truth = groundtruth_file(arguments, {run})) add_groundtruth(*truth, run);
  const fs::path file =
      arguments.out.empty() ? fs::path(arguments.runs[0]) / "report.html" : fs::path(arguments.out);
  if (auto r = write_run_report(run, file); !r) return r;
  fmt::print("report in {}\n", file.string());
  return {};
}

/// Every name once: a second one gets a number.
void make_names_unique(std::vector<RunReportData>& all) {
  std::set<std::string> taken;
  for (RunReportData& run : all) {
    const std::string wanted = run.title;
    for (int i = 2; !taken.insert(run.title).second; ++i)
      run.title = fmt::format("{} {}", wanted, i);
  }
}

Result<void> compare(const ReportArguments& arguments, const std::string& sequence,
                     const std::optional<fs::path>& truth_file, std::vector<RunReportData> all) {
  StampedPoses groundtruth;
  if (truth_file) {
    auto read = read_tum_trajectory(*truth_file);
    if (!read) return read.error();
    groundtruth = *std::move(read);
    for (RunReportData& run : all) {
      auto evaluation = evaluate(groundtruth, run.trajectory);
      if (!evaluation)
        log::warning("{}: {}; shown without errors", run.title, evaluation.error().message);
      if (evaluation) run.evaluation = *std::move(evaluation);
    }
  }
  make_names_unique(all);
  const Result<std::string> html = comparison_report(sequence, groundtruth, all);
  if (!html) return html.error();
  const fs::path file = arguments.out.empty() ? "comparison.html" : arguments.out;
  if (auto r = write_file_atomically(file, *html); !r) return r;
  fmt::print("report in {}\n", file.string());
  return {};
}

Result<void> run_report_command(const ReportArguments& arguments) {
  std::vector<RunReportData> all;
  for (const std::string& folder : arguments.runs) {
    Result<RunReportData> run = load_run(folder);
    if (!run) return run.error();
    all.push_back(*std::move(run));
  }
  if (auto r = check_one_sequence(arguments, all); !r) return r;
  if (all.size() == 1 && arguments.trajectories.empty()) return report_one(arguments, all[0]);
  const std::string sequence = all.empty() ? "Trajectories" : sequence_of(all[0]);
  const std::optional<fs::path> truth_file = groundtruth_file(arguments, all);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].title = name_of(arguments.runs[i]);
  for (const std::string& assignment : arguments.trajectories) {
    Result<RunReportData> peer = load_trajectory(assignment);
    if (!peer) return peer.error();
    all.push_back(*std::move(peer));
  }
  return compare(arguments, sequence, truth_file, std::move(all));
}

}  // namespace

void add_report_command(CLI::App& app, Job& job) {
  const auto arguments = std::make_shared<ReportArguments>();
  auto* command =
      app.add_subcommand("report", "One page that puts runs and other trajectories side by side");
  command->add_option("runs", arguments->runs,
                      "Folders of runs on one sequence; of one run alone its report is made anew");
  command
      ->add_option("--trajectory", arguments->trajectories,
                   "NAME=FILE: a trajectory from elsewhere (TUM format), may be repeated")
      ->allow_extra_args(false);
  command->add_option("--groundtruth", arguments->groundtruth,
                      "True poses (TUM format); default: those that the sequence came with");
  command->add_option("--out", arguments->out,
                      "The page (default comparison.html, or RUN/report.html of one run)");
  command->footer(
      "Examples:\n"
      "  ydd-slam report runs/demo/office-off runs/demo/office --out office.html\n"
      "  ydd-slam report runs/latest --trajectory orb_slam3=CameraTrajectory.txt\n"
      "  ydd-slam report runs/latest");
  command->callback([arguments, &job] {
    if (arguments->runs.empty() && arguments->trajectories.empty()) {
      throw CLI::ValidationError("report", "give at least one run or --trajectory");
    }
    job = [arguments] { return run_report_command(*arguments); };
  });
}

}  // namespace ydd::app
