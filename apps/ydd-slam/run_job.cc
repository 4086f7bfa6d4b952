// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>
#include <opencv2/core/version.hpp>

#include "default_detector.h"
#include "moment_files.h"
#include "run_folder.h"
#include "run_job.h"
#include "run_map.h"
#include "run_pictures.h"
#include "run_report.h"
#include "run_watch.h"
#include "ydd/base/files.h"
#include "ydd/base/timing.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/tum_sequence.h"
#include "ydd/detection/detector_config.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/map/map_dump.h"
#include "ydd/system/run_recorder.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

/// What a run is configured with, and what it leaves as config.yaml.
struct Configuration {
  SystemOptions options;
  Camera camera;

  void describe(OptionTable& table) {
    options.describe(table);
    table.group("camera", camera);
  }
};

/// Command line > file > default. The camera's default is that of the sequence; a saved
/// configuration has a camera too, so that it repeats its run wherever it is fed back.
Result<Configuration> effective_configuration(const RunRequest& request) {
  Result<Camera> camera = find_camera(request.sequence, request.camera);
  if (!camera) return camera.error();
  Configuration out{{}, *camera};
  OptionTable table;
  out.describe(table);
  if (!request.config.empty()) {
    if (auto r = table.load_yaml(request.config); !r) return r.error();
  }
  if (!request.camera.empty()) out.camera = *camera;
  for (const std::string& assignment : request.set) {
    if (auto r = table.set_assignment(assignment, "--set"); !r) return r.error();
  }
  if (!request.dynamic.empty()) {
    if (auto r = table.set("dynamics.variant", request.dynamic, "--dynamic"); !r) return r.error();
  }
  if (!request.detect.empty()) {
    if (auto r = table.set("detect.mode", request.detect, "--detect"); !r) return r.error();
  }
  if (request.deterministic) out.options.deterministic = true;
  if (request.seed >= 0) out.options.tracking.relocalization.seed = request.seed;
  return out;
}

Result<ObjectCatalogue> run_catalogue(const RunRequest& request) {
  return request.objects.empty() ? Result(ObjectCatalogue::defaults())
                                 : ObjectCatalogue::load(request.objects);
}

/// The request with the detector that it means: a run that rejects nothing, or replays recorded
/// boxes, looks at nothing.
Result<RunRequest> with_detector(RunRequest request, const std::string& variant) {
  if (!request.detector.empty() && !request.detections.empty()) {
    return Error{"--detector and --detections: give one of the two"};
  }
  if (request.detector.empty() && request.detections.empty() && variant != "off") {
    Result<std::string> detector = default_detector();
    if (!detector) return detector.error();
    request.detector = *std::move(detector);
  }
  if (request.detector == kNoDetector) request.detector.clear();
  return request;
}

Result<std::unique_ptr<Detector>> make_run_detector(const RunRequest& request,
                                                    const ObjectCatalogue& catalogue) {
  if (!request.detector.empty()) {
    return make_detector(request.detector, request.detector_set, catalogue);
  }
  if (request.detections.empty()) return std::unique_ptr<Detector>();
  Result<DetectionRecording> recording = DetectionRecording::read(request.detections);
  if (!recording) return recording.error();
  return std::unique_ptr<Detector>(
      std::make_unique<RecordedDetector>(std::move(*recording), request.detections));
}

Result<void> write_results(const fs::path& folder, const RunRequest& request,
                           const std::string& config, const SlamSystem& system,
                           const RunRecorder& recorder, const std::string& summary) {
  const auto format = parse_trajectory_format(request.trajectory_format);
  if (!format) return Error{"--trajectory-format: must be tum, kitti or euroc"};
  const std::string extension = request.trajectory_format == "tum" ? "tum" : "txt";
  const StampedPoses trajectory = system.trajectory();
  const std::pair<std::string, std::string> files[] = {
      {"trajectory.tum", format_trajectory(trajectory, TrajectoryFormat::tum)},
      {"keyframes.tum", format_trajectory(system.keyframe_trajectory(), TrajectoryFormat::tum)},
      {"config.yaml", config},
      {"frames.json", recorder.frames_json()},
      {"timings.json", recorder.timings_json(system)},
      {"summary.json", summary},
  };
  for (const auto& [name, content] : files) {
    if (auto r = write_file_atomically(folder / name, content); !r) return r;
  }
  if (*format != TrajectoryFormat::tum) {
    const std::string name = fmt::format("trajectory.{}.{}", request.trajectory_format, extension);
    if (auto r = write_trajectory(folder / name, trajectory, *format); !r) return r;
  }
  if (request.dump_map) {
    return write_file_atomically(folder / "map.txt", dump_map(*system.atlas()));
  }
  return {};
}

/// The pictures of key moments, and the page with everything.
Result<void> write_report(const fs::path& folder, const Sequence& sequence, const Camera& camera,
                          const ObjectCatalogue& catalogue, const SlamSystem& system,
                          const KeyMoments& moments) {
  const auto read_colour = [&](std::int64_t frame) -> Result<ColourImage> {
    const auto read = sequence.read(static_cast<std::size_t>(frame), camera);
    if (!read) return read.error();
    return read->colour;
  };
  const auto pictures =
      moments.draw(catalogue, system.mapping_reports().loops, *system.atlas(), read_colour);
  if (auto r = write_moments(folder, pictures); !r) return r;
  RunReportData data = read_run(folder);
  data.trajectory = system.trajectory();
  if (const auto& file = sequence.groundtruth_file()) add_groundtruth(*file, data);
  return write_run_report(data, folder / "report.html");
}

std::map<std::string, std::string> library_versions() {
  return {{"Eigen",
           fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"OpenCV", CV_VERSION},
          {"compiler", __VERSION__}};
}

RunDescription describe_run(const RunRequest& request, const Sequence& sequence,
                            const SystemOptions& options, bool has_detector) {
  RunDescription out{sequence.name(),
                     has_detector ? options.dynamics.variant : "off",
                     request.detector + request.detections,  // one is empty
                     options.deterministic,
                     request.realtime,
                     options.tracking.relocalization.seed};
  if (const auto& file = sequence.groundtruth_file()) {
    out.groundtruth = fs::absolute(*file).lexically_normal().string();
  }
  out.versions = library_versions();
  return out;
}

std::string effective_yaml(Configuration configuration) {
  OptionTable table;
  configuration.describe(table);
  return table.to_yaml();
}

}  // namespace

Result<RunOutcome> run_sequence(const RunRequest& asked) {
  if (auto r = check_watchers(asked); !r) return r.error();
  Result<Sequence> sequence = Sequence::open(asked.sequence, asked.sequence_options);
  if (!sequence) return sequence.error();
  const Result<Configuration> configuration = effective_configuration(asked);
  if (!configuration) return configuration.error();
  const SystemOptions& options = configuration->options;
  const Result<RunRequest> completed = with_detector(asked, options.dynamics.variant);
  if (!completed) return completed.error();
  const RunRequest& request = *completed;
  const Camera& camera = configuration->camera;
  Result<ObjectCatalogue> catalogue = run_catalogue(request);
  if (!catalogue) return catalogue.error();
  Result<std::unique_ptr<Detector>> detector = make_run_detector(request, *catalogue);
  if (!detector) return detector.error();
  Result<std::optional<Atlas>> map = open_run_map(request, camera, options);
  if (!map) return map.error();
  Result<RunFolder> folder = RunFolder::make(request.out, sequence->name());
  if (!folder) return folder.error();
  Listeners listeners;
  auto pictures = RunPictures::open(request, camera, *catalogue);
  if (!pictures) return pictures.error();
  listeners.pictures = *std::move(pictures);

  const bool has_detector = *detector != nullptr;
  SlamSystem system(camera, options, *catalogue, std::move(*detector), std::move(*map));
  if (auto r = prepare_run_map(request, system); !r) return r.error();
  const std::int64_t start_ns = wall_clock_ns();
  const FeedInput input{*sequence, camera, request, *catalogue};
  if (auto r = feed_watched(input, system, listeners, has_detector, folder->path()); !r) {
    return r.error();
  }
  const double wall_s = static_cast<double>(wall_clock_ns() - start_ns) * 1e-9;
  if (auto r = save_run_map(request, system); !r) return r.error();
  if (listeners.pictures) {
    if (auto r = listeners.pictures->finish(); !r) return r.error();
  }

  const RunDescription description = describe_run(request, *sequence, options, has_detector);
  const std::string summary = listeners.recorder.summary_json(description, system, wall_s);
  if (auto r = write_results(folder->path(), request, effective_yaml(*configuration), system,
                             listeners.recorder, summary);
      !r) {
    return r.error();
  }
  if (auto r =
          write_report(folder->path(), *sequence, camera, *catalogue, system, listeners.moments);
      !r) {
    return r.error();
  }
  folder->keep();
  return RunOutcome{folder->path(),
                    summary,
                    listeners.recorder.timings_json(system),
                    system.trajectory(),
                    sequence->groundtruth_file(),
                    system.atlas(),
                    listeners.recorder.processed(),
                    listeners.recorder.tracked()};
}

}  // namespace ydd::app
