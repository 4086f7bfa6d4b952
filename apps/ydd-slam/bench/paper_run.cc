// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/bench_paper.h"
#include "common/child_run.h"
#include "common/default_detector.h"
#include "ydd/base/cores.h"
#include "ydd/base/files.h"
#include "ydd/base/json_reader.h"
#include "ydd/base/json_text.h"
#include "ydd/base/version.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Result<fs::path> recorded_boxes(const fs::path& folder) {
  for (const char* name : {"detections.jsonl", "detections_gt.jsonl"}) {
    if (fs::exists(folder / name)) return folder / name;
  }
  return Error{
      fmt::format("{}: has no detections.jsonl for --detector recorded; record one with "
                  "'ydd-slam detect'",
                  folder.string())};
}

Result<std::vector<std::string>> arguments_of(const PaperRequest& request, const PaperRun& run) {
  std::vector<std::string> out{run.sequence.folder.string(), "--dynamic", run.variant, "--seed",
                               std::to_string(run.run)};
  const auto option = [&](const char* name, const std::string& value) {
    out.insert(out.end(), {name, value});
  };
  if (request.detector == kRecordedBoxes) {
    const Result<fs::path> boxes = recorded_boxes(run.sequence.folder);
    if (!boxes) return boxes.error();
    option("--detections", boxes->string());
  } else if (!request.detector.empty()) {
    option("--detector", request.detector);
  }
  for (const std::string& assignment : request.detector_set) option("--detector-set", assignment);
  for (const std::string& assignment : request.set) option("--set", assignment);
  if (request.realtime) out.emplace_back("--realtime");
  return out;
}

void add_use(const ProcessUse& use, RunFigures& figures) {
  const auto add = [&](const char* key, double value) {
    if (value > 0) figures.values[key] = value;
  };
  add("virtual_mb", use.virtual_mb);
  add("resident_mb", use.resident_mb);
  add("shared_mb", use.shared_mb);
  if (use.wall_s > 0) add("cpu_percent", 100 * use.cpu_s / use.wall_s / available_cores());
}

/// Wall clock of a stage, median and mean; nothing where it did not run.
void add_stage(const Json& timings, const char* stage, const std::string& quantity,
               RunFigures& figures) {
  const Json& stages = timings.at("per_frame");
  if (!stages.contains(stage)) return;
  for (const char* statistic : {"median", "mean"}) {
    figures.values[quantity + "." + statistic] = stages.at(stage).at("wall_ms").at(statistic);
  }
}

Result<Json> json_of(const fs::path& file) {
  const Result<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_json(*text, file.string());
}

/// Everything that the folder of a run tells.
Result<void> add_run(const fs::path& folder, const KeptRun& run, bool looks, RunFigures& figures) {
  const Json& summary = run.results.summary;
  const auto processed = summary.at("frames_processed").get<double>();
  if (processed > 0) {
    figures.values["tracked_share"] = summary.at("frames_tracked").get<double>() / processed;
  }
  figures.values["frames"] = processed;
  figures.values["wall_s"] = run.use.wall_s;
  figures.values["cpu_s"] = run.use.cpu_s;
  add_stage(run.results.timings, "total", "tracking_ms", figures);
  add_stage(run.results.timings, "dynamics", "decision_ms", figures);
  // Reading recorded boxes takes a time as well, but not a network's.
  if (looks) add_stage(run.results.timings, "detect", "network_ms", figures);
  const Result<Json> frames = json_of(folder / "frames.json");
  if (!frames) return frames.error();
  const Json& stamps = frames->at("stamp_s");
  if (!stamps.empty()) {
    figures.values["span_s"] = stamps.back().get<double>() - stamps.front().get<double>();
  }
  for (const Json& requested : frames->at("requested")) {
    figures.curves.requested.push_back(requested.get<double>());
  }
  const Result<StampedPoses> trajectory = read_tum_trajectory(folder / "trajectory.tum");
  if (!trajectory) return {};  // nothing was tracked: it shows in the share
  const auto truth_file = summary.at("groundtruth").get<std::string>();
  if (truth_file.empty()) {
    for (const StampedPose& pose : *trajectory) {
      figures.curves.estimate_m.push_back(pose.T_world_camera.translation());
    }
    return {};
  }
  const Result<StampedPoses> truth = read_tum_trajectory(truth_file);
  if (!truth) return truth.error();
  score_trajectory(*truth, *trajectory, figures);
  return {};
}

/// The detector over the sequence, without a tracker.
Result<RunFigures> measure_network(const PaperRequest& request, const PaperRun& run,
                                   const fs::path& scratch, RunFigures figures) {
  std::vector<std::string> arguments{"detect", run.sequence.folder.string(), "--quiet", "--out",
                                     (scratch / "boxes.jsonl").string()};
  if (!request.detector.empty()) {
    arguments.insert(arguments.end(), {"--detector", request.detector});
  }
  for (const std::string& assignment : request.detector_set) {
    arguments.insert(arguments.end(), {"--set", assignment});
  }
  const Result<ProcessUse> use = run_self(std::move(arguments), scratch / "detect.log");
  if (!use) return use.error();
  add_use(*use, figures);
  return figures;
}

}  // namespace

std::string paper_settings(const PaperRequest& request, const PaperSequence& sequence) {
  std::error_code unknown;
  return json_text(Json{{"version", kVersion},
                        {"folder", fs::weakly_canonical(sequence.folder, unknown).string()},
                        {"detector", request.detector},
                        {"detector_set", request.detector_set},
                        {"set", request.set},
                        {"realtime", request.realtime}});
}

fs::path figures_file(const PaperRequest& request, const PaperRun& run) {
  return fs::path(request.out) / "runs" / run.sequence.name /
         fmt::format("{}-{}.json", run.variant, run.run);
}

Result<RunFigures> make_paper_run(const PaperRequest& request, const PaperRun& run,
                                  const fs::path& scratch) {
  RunFigures figures;
  figures.settings = paper_settings(request, run.sequence);
  figures.sequence = run.sequence.name;
  figures.variant = run.variant;
  figures.run = run.run;
  if (run.variant == kNetworkAlone) return measure_network(request, run, scratch, figures);
  const Result<std::vector<std::string>> arguments = arguments_of(request, run);
  if (!arguments) return arguments.error();
  const fs::path folder = scratch / "run";
  const Result<KeptRun> kept = run_in_child_keeping(*arguments, folder);
  if (!kept) return kept.error();
  add_use(kept->use, figures);
  const bool looks = request.detector != kRecordedBoxes && run.variant != "off";
  const Result<void> added = add_run(folder, *kept, looks, figures);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  if (!added) return added.error();
  return figures;
}

}  // namespace ydd::app
