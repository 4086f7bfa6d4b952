// SPDX-License-Identifier: Apache-2.0
#include "run/run_configuration.h"

#include <utility>

#include <fmt/format.h>

#include "common/default_detector.h"
#include "ydd/base/log.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/motion_files.h"
#include "ydd/detection/detector_config.h"
#include "ydd/detection/person_check.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/sources/source.h"

namespace ydd::app {

void Configuration::describe(OptionTable& table) {
  options.describe(table);
  table.group("camera", camera);
  table.group("sequence", sequence);
}

std::string Configuration::to_yaml() const {
  Configuration copy = *this;  // a table can also set what it describes
  OptionTable table;
  copy.describe(table);
  return table.to_yaml();
}

namespace {

/// `camera`: the default one.
Result<Configuration> configuration_with(const RunRequest& request, const Camera& camera) {
  Configuration out{{}, camera, {}};
  OptionTable table;
  out.describe(table);
  if (!request.config.empty()) {
    if (auto r = table.load_yaml(request.config); !r) return r.error();
  }
  if (!request.camera.empty()) out.camera = camera;
  for (const std::string& assignment : request.set) {
    if (auto r = table.set_assignment(assignment, "--set"); !r) return r.error();
  }
  if (request.max_difference_s) {
    const std::string value = fmt::format("{}", *request.max_difference_s);
    if (auto r = table.set("sequence.max_difference_s", value, "--max-difference"); !r) {
      return r.error();
    }
  }
  if (request.source) out.sequence.source = *request.source;
  if (request.topic_colour) out.sequence.topic_colour = *request.topic_colour;
  if (request.topic_depth) out.sequence.topic_depth = *request.topic_depth;
  if (request.topic_camera_info) out.sequence.topic_camera_info = *request.topic_camera_info;
  if (request.depth_offset) out.sequence.depth_offset = *request.depth_offset;
  if (request.depth_shift) out.sequence.depth_shift = *request.depth_shift;
  if (request.first_frame) out.sequence.first_frame = *request.first_frame;
  if (request.max_frames) out.sequence.max_frames = *request.max_frames;
  if (request.associations) {  // the configuration may be fed back in another folder
    out.sequence.associations = std::filesystem::absolute(*request.associations).string();
  }
  if (!request.dynamic.empty()) {
    if (auto r = table.set("dynamics.variant", request.dynamic, "--dynamic"); !r) return r.error();
  }
  if (!request.detect.empty()) {
    if (auto r = table.set("detect.mode", request.detect, "--detect"); !r) return r.error();
  }
  if (request.deterministic) out.options.deterministic = true;
  if (request.seed >= 0) {
    out.options.tracking.relocalization.seed = request.seed;
    out.options.loop.match.seed = request.seed;
  }
  if (auto r = check(out.options.reckoning); !r) return r.error();
  return out;
}

}  // namespace

Result<ConfiguredRecording> effective_configuration(const RunRequest& request) {
  // The recording tells the default camera, and the options tell how to read the recording.
  Result<Configuration> first = configuration_with(request, Camera());
  if (!first) return first.error();
  Result<Recording> recording = open_recording(request.sequence, first->sequence);
  if (!recording) return recording.error();
  const Result<Camera> camera = find_camera(*recording, request.camera);
  if (!camera) return camera.error();
  Result<Configuration> configuration = configuration_with(request, *camera);
  if (!configuration) return configuration.error();
  return ConfiguredRecording{*std::move(configuration), *std::move(recording)};
}

Result<MotionSamples> run_motion(const RunRequest& request) {
  MotionSamples samples;
  if (!request.imu.empty()) {
    auto imu = read_imu_file(request.imu);
    if (!imu) return imu.error();
    samples.imu = *std::move(imu);
  }
  if (!request.odometry.empty()) {
    auto odometry = read_odometry_file(request.odometry);
    if (!odometry) return odometry.error();
    samples.odometry = *std::move(odometry);
  }
  return samples;
}

Result<ObjectCatalogue> run_catalogue(const RunRequest& request) {
  return request.objects.empty() ? Result(ObjectCatalogue::defaults())
                                 : ObjectCatalogue::load(request.objects);
}

Result<RunRequest> with_detector(RunRequest request, Variant variant) {
  if (!request.detector.empty() && !request.detections.empty()) {
    return Error{"--detector and --detections: give one of the two"};
  }
  if (request.detector.empty() && request.detections.empty() && variant != Variant::off) {
    Result<std::string> detector = default_detector();
    if (!detector) return detector.error();
    request.detector = *std::move(detector);
  }
  if (request.detector == kNoDetector) request.detector.clear();
  if (request.detector.empty() && !request.detector_set.empty()) {
    return Error{
        "--detector-set: this run has no detector whose options it could set (recorded boxes are "
        "replayed, or nothing is looked at); leave it out"};
  }
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
  if (const auto nobody = nobody_warning(*recording, catalogue, request.detections)) {
    log::warning("{}", *nobody);
  }
  return std::unique_ptr<Detector>(std::make_unique<RecordedDetector>(
      named_by_rules(std::move(*recording), catalogue), request.detections));
}

}  // namespace ydd::app
