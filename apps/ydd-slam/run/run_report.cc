// SPDX-License-Identifier: Apache-2.0
#include "run/run_report.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "run/moment_files.h"
#include "ydd/base/files.h"
#include "ydd/base/json_reader.h"
#include "ydd/base/log.h"
#include "ydd/report/html_report.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

/// Older runs lack some files; their report lacks what these would tell.
std::string text_of(const fs::path& file) {
  auto text = read_file(file);
  return text ? *std::move(text) : std::string();
}

/// A text of the summary; nothing where it does not tell it.
std::optional<std::string> told(const std::string& summary, const char* key) {
  const auto json = parse_json(summary, "summary.json");
  if (!json || !json->is_object() || !json->contains(key) || !json->at(key).is_string()) {
    return std::nullopt;
  }
  return json->at(key).get<std::string>();
}

}  // namespace

bool is_run_folder(const fs::path& folder) { return fs::is_regular_file(folder / "summary.json"); }

std::string sequence_of(const RunReportData& run) {
  return told(run.summary_json, "sequence").value_or(run.title);
}

std::optional<fs::path> groundtruth_file_of(const RunReportData& run) {
  const auto file = told(run.summary_json, "groundtruth");
  return file && !file->empty() ? std::optional<fs::path>(*file) : std::nullopt;
}

RunReportData read_run(const fs::path& folder) {
  RunReportData data;
  data.summary_json = text_of(folder / "summary.json");
  data.frames_json = text_of(folder / "frames.json");
  data.timings_json = text_of(folder / "timings.json");
  data.tracks_jsonl = text_of(folder / "tracks.jsonl");
  data.config = text_of(folder / "config.yaml");
  data.title = told(data.summary_json, "sequence").value_or(folder.filename().string());
  data.moments = read_moments(folder);
  return data;
}

void add_groundtruth(const fs::path& file, RunReportData& data) {
  Result<StampedPoses> groundtruth = read_tum_trajectory(file);
  if (!groundtruth) {
    log::warning("{}; report without ground truth", groundtruth.error().message);
    return;
  }
  Result<Evaluation> evaluation = evaluate(*groundtruth, data.trajectory);
  if (!evaluation) {
    log::warning("{}: {}; report without errors", file.string(), evaluation.error().message);
    return;
  }
  data.groundtruth = *std::move(groundtruth);
  data.evaluation = *std::move(evaluation);
}

Result<void> write_run_report(const RunReportData& data, const fs::path& file) {
  const Result<std::string> html = html_report(data);
  if (!html) return Error{file.string() + ": " + html.error().message};
  return write_file_atomically(file, *html);
}

}  // namespace ydd::app
