// SPDX-License-Identifier: Apache-2.0
#include "run_report.h"

#include <nlohmann/json.hpp>

#include "ydd/base/files.h"
#include "ydd/base/log.h"
#include "ydd/evaluation/html_report.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

/// Older runs lack some files; their report lacks what these would tell.
std::string text_of(const fs::path& file) {
  auto text = read_file(file);
  return text ? *std::move(text) : std::string();
}

/// The sequence's name, or the folder's where no summary tells it.
std::string title_of(const std::string& summary, const fs::path& folder) {
  const auto json = nlohmann::json::parse(summary, nullptr, false);
  return json.is_object() ? json.value("sequence", folder.filename().string())
                          : folder.filename().string();
}

}  // namespace

bool is_run_folder(const fs::path& folder) { return fs::is_regular_file(folder / "summary.json"); }

Result<void> write_run_report(const fs::path& folder, const StampedPoses& trajectory,
                              const StampedPoses& groundtruth,
                              const std::optional<Evaluation>& evaluation) {
  RunReportData data;
  data.summary_json = text_of(folder / "summary.json");
  data.frames_json = text_of(folder / "frames.json");
  data.timings_json = text_of(folder / "timings.json");
  data.config = text_of(folder / "config.yaml");
  data.title = title_of(data.summary_json, folder);
  data.trajectory = trajectory;
  data.groundtruth = groundtruth;
  data.evaluation = evaluation;
  const Result<std::string> html = html_report(data);
  if (!html) return Error{(folder / "report.html").string() + ": " + html.error().message};
  return write_file_atomically(folder / "report.html", *html);
}

Result<void> write_run_report(const fs::path& folder, const StampedPoses& trajectory,
                              const std::optional<fs::path>& groundtruth_file) {
  if (!groundtruth_file) return write_run_report(folder, trajectory, StampedPoses(), std::nullopt);
  const Result<StampedPoses> groundtruth = read_tum_trajectory(*groundtruth_file);
  if (!groundtruth) {
    log::warning("{}; report without ground truth", groundtruth.error().message);
    return write_run_report(folder, trajectory, StampedPoses(), std::nullopt);
  }
  Result<Evaluation> evaluation = evaluate(*groundtruth, trajectory);
  if (!evaluation) {
    log::warning("{}: {}; report without errors", groundtruth_file->string(),
                 evaluation.error().message);
    return write_run_report(folder, trajectory, StampedPoses(), std::nullopt);
  }
  return write_run_report(folder, trajectory, *groundtruth, *std::move(evaluation));
}

}  // namespace ydd::app
