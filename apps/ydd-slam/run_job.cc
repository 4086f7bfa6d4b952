// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>
#include <opencv2/core/version.hpp>

#include "moment_files.h"
#include "progress.h"
#include "run_folder.h"
#include "run_job.h"
#include "run_pictures.h"
#include "run_report.h"
#include "ydd/base/files.h"
#include "ydd/base/log.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/frame_source.h"
#include "ydd/dataset/tum_sequence.h"
#include "ydd/detection/detector_config.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/map/map_dump.h"
#include "ydd/system/run_recorder.h"
#include "ydd/viewer/key_moments.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

/// Real-time pace: which frame is due, and waiting for it.
class Pace {
 public:
  explicit Pace(Timestamp first) : first_(first), start_(std::chrono::steady_clock::now()) {}

  void wait_until_due(Timestamp stamp) const { std::this_thread::sleep_until(due(stamp)); }
  bool is_due(Timestamp stamp) const { return std::chrono::steady_clock::now() >= due(stamp); }

 private:
  std::chrono::steady_clock::time_point due(Timestamp stamp) const {
    return start_ + std::chrono::nanoseconds(stamp.ns - first_.ns);
  }
  Timestamp first_;
  std::chrono::steady_clock::time_point start_;
};

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

Result<std::unique_ptr<Detector>> make_run_detector(const RunRequest& request,
                                                    const ObjectCatalogue& catalogue) {
  if (!request.detector.empty() && !request.detections.empty()) {
    return Error{"--detector and --detections: give one of the two"};
  }
  if (!request.detector.empty()) {
    return make_detector(request.detector, request.detector_set, catalogue);
  }
  if (request.detections.empty()) return std::unique_ptr<Detector>();
  Result<DetectionRecording> recording = DetectionRecording::read(request.detections);
  if (!recording) return recording.error();
  return std::unique_ptr<Detector>(
      std::make_unique<RecordedDetector>(std::move(*recording), request.detections));
}

std::string state_text(const FrameReport& report, const SlamSystem& system) {
  const Observations& seen = *report.observations;
  const double share = seen.extracted() == 0 ? 0.0
                                             : 100.0 * static_cast<double>(seen.rejected.size()) /
                                                   static_cast<double>(seen.extracted());
  const auto atlas = system.atlas();
  return fmt::format("{}  {} keyframes  {} points  {:.0f} % rejected",
                     to_string(report.track.state), atlas->keyframes().size(),
                     atlas->points().size(), share);
}

MapSize map_size(const SlamSystem& system) {
  const auto atlas = system.atlas();
  return {atlas->keyframes().size(), atlas->points().size()};
}

/// Whether a live camera would have overtaken frame `i` by now: then it is dropped, and counted.
bool overtaken(const Sequence& sequence, std::size_t i, std::size_t end, const Pace& pace) {
  return i + 1 < end && pace.is_due(sequence.entry(i + 1).stamp);
}

/// Who hears of every frame.
struct Listeners {
  RunRecorder recorder;
  KeyMoments moments;
  std::unique_ptr<RunPictures> pictures;  ///< null: none are asked for
};

/// One frame that could be read: through the system, to all who listen.
Result<void> feed_frame(const RgbdFrame& frame, SlamSystem& system, Listeners& listeners,
                        Progress& progress) {
  Result<FrameReport> report = system.process(frame);
  if (!report) return report.error();
  listeners.recorder.add(*report, map_size(system));
  listeners.moments.add(frame, *report);
  progress.update(static_cast<std::size_t>(frame.index) + 1, state_text(*report, system));
  if (!listeners.pictures) return {};
  return listeners.pictures->add(frame, *report, system.atlas());
}

/// Feeds the sequence to the system; the recorder keeps what happened.
Result<void> feed(const Sequence& sequence, const Camera& camera, const RunRequest& request,
                  SlamSystem& system, Listeners& listeners) {
  RunRecorder& recorder = listeners.recorder;
  const std::size_t end =
      request.max_frames > 0
          ? std::min(sequence.size(), static_cast<std::size_t>(request.max_frames))
          : sequence.size();
  Progress progress(sequence.name(), end, request.quiet);
  FrameSource source(sequence, camera);
  const Pace pace(sequence.entry(0).stamp);
  for (std::size_t i = 0; i < end; ++i) {
    const auto frame = source.next();
    if (!frame) break;
    if (request.realtime && overtaken(sequence, i, end, pace)) {
      recorder.add_dropped(1);
      continue;
    }
    if (request.realtime) pace.wait_until_due(sequence.entry(i).stamp);
    if (!*frame) {
      const std::string reason = fmt::format("frame {}: {}", i, frame->error().message);
      if (request.strict) return Error{reason};
      log::warning("{}; skipped", reason);
      recorder.add_skipped(static_cast<std::int64_t>(i), frame->error().message);
    } else if (auto r = feed_frame(**frame, system, listeners, progress); !r) {
      return r;
    }
  }
  system.finish();
  if (recorder.processed() == 0) {
    return Error{fmt::format("{}: not one frame could be read", sequence.folder().string())};
  }
  return {};
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

std::string effective_yaml(Configuration configuration) {
  OptionTable table;
  configuration.describe(table);
  return table.to_yaml();
}

}  // namespace

Result<RunOutcome> run_sequence(const RunRequest& request) {
  Result<Sequence> sequence = Sequence::open(request.sequence, request.sequence_options);
  if (!sequence) return sequence.error();
  const Result<Configuration> configuration = effective_configuration(request);
  if (!configuration) return configuration.error();
  const SystemOptions& options = configuration->options;
  const Camera& camera = configuration->camera;
  Result<ObjectCatalogue> catalogue = run_catalogue(request);
  if (!catalogue) return catalogue.error();
  Result<std::unique_ptr<Detector>> detector = make_run_detector(request, *catalogue);
  if (!detector) return detector.error();
  Result<RunFolder> folder = RunFolder::make(request.out, sequence->name());
  if (!folder) return folder.error();
  Listeners listeners;
  auto pictures = RunPictures::open(request, camera, *catalogue);
  if (!pictures) return pictures.error();
  listeners.pictures = *std::move(pictures);

  const bool has_detector = *detector != nullptr;
  SlamSystem system(camera, options, *catalogue, std::move(*detector));
  const RunRecorder& recorder = listeners.recorder;
  const std::int64_t start_ns = wall_clock_ns();
  if (auto r = feed(*sequence, camera, request, system, listeners); !r) return r.error();
  const double wall_s = static_cast<double>(wall_clock_ns() - start_ns) * 1e-9;
  if (listeners.pictures) {
    if (auto r = listeners.pictures->finish(); !r) return r.error();
  }

  RunDescription description{sequence->name(),
                             has_detector ? options.dynamics.variant : "off",
                             request.detector + request.detections,  // one is empty
                             options.deterministic,
                             request.realtime,
                             options.tracking.relocalization.seed};
  if (const auto& file = sequence->groundtruth_file()) {
    description.groundtruth = fs::absolute(*file).lexically_normal().string();
  }
  description.versions = library_versions();
  const std::string summary = recorder.summary_json(description, system, wall_s);
  if (auto r = write_results(folder->path(), request, effective_yaml(*configuration), system,
                             recorder, summary);
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
                    recorder.timings_json(system),
                    system.trajectory(),
                    sequence->groundtruth_file(),
                    system.atlas(),
                    recorder.processed(),
                    recorder.tracked()};
}

}  // namespace ydd::app
