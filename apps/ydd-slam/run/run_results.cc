// SPDX-License-Identifier: Apache-2.0
#include "run/run_results.h"

#include <exception>
#include <map>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Core>
#include <opencv2/core/version.hpp>

#include "run/moment_files.h"
#include "run/run_map.h"
#include "run/run_report.h"
#include "ydd/base/files.h"
#include "ydd/base/log.h"
#include "ydd/map/map_dump.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

std::map<std::string, std::string> library_versions() {
  return {{"Eigen",
           fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"OpenCV", CV_VERSION},
          {"compiler", __VERSION__}};
}

Result<void> write_other_format(const RunResults& results, const StampedPoses& trajectory) {
  const std::string& name = results.request.trajectory_format;
  const auto format = parse_trajectory_format(name);
  if (!format) return Error{"--trajectory-format: must be tum, kitti or euroc"};
  if (*format == TrajectoryFormat::tum) return {};
  return write_trajectory(results.folder / fmt::format("trajectory.{}.txt", name), trajectory,
                          *format);
}

void write_data(const RunResults& results, Attempts& attempts) {
  const SlamSystem& system = results.system;
  const RunRecorder& recorder = results.listeners.recorder;
  const StampedPoses trajectory = system.trajectory();
  const auto write = [&](const char* name, const std::function<std::string()>& content) {
    attempts.attempt([&] { return write_file_atomically(results.folder / name, content()); });
  };
  write("trajectory.tum", [&] { return format_trajectory(trajectory, TrajectoryFormat::tum); });
  write("keyframes.tum",
        [&] { return format_trajectory(system.keyframe_trajectory(), TrajectoryFormat::tum); });
  write("config.yaml", [&] { return results.configuration.to_yaml(); });
  write("frames.json", [&] { return recorder.frames_json(); });
  write("tracks.jsonl", [&] { return results.listeners.tracks.jsonl(*system.atlas()); });
  write("timings.json", [&] { return recorder.timings_json(system); });
  write("summary.json", [&] { return results.summary; });
  attempts.attempt([&] { return write_other_format(results, trajectory); });
  if (results.request.dump_map) write("map.txt", [&] { return dump_map(*system.atlas()); });
}

/// The pictures of key moments, and the page with everything.
Result<void> write_report(const RunResults& results) {
  const Sequence& sequence = results.sequence;
  const auto read_colour = [&](std::int64_t frame) -> Result<ColourImage> {
    // Whose boxes nobody keeps: a redacted run shows no frame that it has to read again.
    if (results.request.redact) return Error{"is not shown"};
    return sequence.read_colour(static_cast<std::size_t>(frame));
  };
  const SlamSystem& system = results.system;
  const auto pictures = results.listeners.moments.draw(
      results.catalogue, system.mapping_reports().loops, *system.atlas(), read_colour);
  if (auto r = write_moments(results.folder, pictures); !r) return r;
  RunReportData data = read_run(results.folder);
  data.trajectory = system.trajectory();
  if (const auto& file = results.groundtruth_file) add_groundtruth(*file, data);
  return write_run_report(data, results.folder / "report.html");
}

}  // namespace

void Attempts::attempt(const std::function<Result<void>()>& step) {
  try {
    if (const Result<void> r = step(); !r) failures_.push_back(r.error().message);
  } catch (const std::bad_alloc&) {
    failures_.emplace_back("out of memory while results were written");
  } catch (const std::exception& e) {
    failures_.push_back(fmt::format("internal: {}", e.what()));
  }
}

std::string Attempts::failures() const { return fmt::format("{}", fmt::join(failures_, "; ")); }

std::optional<fs::path> place_groundtruth(const RunResults& results, Attempts& attempts) {
  const std::optional<GroundTruth>& truth = results.sequence.groundtruth();
  if (!truth) return std::nullopt;
  if (truth->is_tum_file) return truth->place;
  const fs::path file = results.folder / "groundtruth.tum";
  bool is_there = false;
  attempts.attempt([&]() -> Result<void> {
    const Result<StampedPoses> poses = truth->read();
    if (!poses) {
      log::warning("{}; no ground truth", poses.error().message);
      return {};
    }
    is_there = true;
    return write_trajectory(file, *poses);
  });
  return is_there ? std::optional(file) : std::nullopt;
}

std::string summary_of(const RunResults& results, double wall_s) {
  const RunRequest& request = results.request;
  const SystemOptions& options = results.configuration.options;
  const Variant asked = options.dynamics.variant;
  const Variant variant = results.has_detector ? asked : without_boxes(asked);
  RunDescription run{results.sequence.name(),
                     std::string(to_string(variant)),
                     request.detector + request.detections,  // one is empty
                     options.deterministic,
                     request.realtime,
                     options.tracking.relocalization.seed};
  if (const auto& file = results.groundtruth_file) {
    run.groundtruth = fs::absolute(*file).lexically_normal().string();
  }
  run.pairing = results.sequence.pairing();
  run.depth_shift = results.sequence.depth_shift();
  run.incomplete = results.end.incomplete;
  run.versions = library_versions();
  run.device = results.detector_device;
  return results.listeners.recorder.summary_json(run, results.system, wall_s);
}

void write_results(const RunResults& results, Attempts& attempts) {
  write_data(results, attempts);
  if (results.listeners.recording) {
    attempts.attempt([&] { return results.listeners.recording->finish(); });
  }
  if (results.listeners.foxglove) {
    attempts.attempt([&] { return results.listeners.foxglove->finish(); });
  }
  if (results.listeners.pictures) {
    attempts.attempt([&] { return results.listeners.pictures->finish(); });
  }
  const bool tracked = results.listeners.recorder.tracked() > 0;
  // A map of nothing replaces none.
  if (tracked) attempts.attempt([&] { return save_run_map(results.request, results.system); });
  attempts.attempt([&] { return write_report(results); });
}

}  // namespace ydd::app
