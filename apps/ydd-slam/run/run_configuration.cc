// SPDX-License-Identifier: Apache-2.0
#include "run/run_configuration.h"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

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
  if (request.camera_mode) out.sequence.camera_mode = *request.camera_mode;
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

/// A sensor of motion that a run may use.
struct MotionWanted {
  const char* option;
  std::string asked;                ///< file, topic, "off"; empty: nothing is said
  std::vector<std::string> topics;  ///< of the recording
  const char* mounting;             ///< the option that says where it is
  bool is_mounted;                  ///< and whether it does
};

constexpr const char* kNoSensor = "off";

/// Whether it names something that is no topic.
bool is_file_of_motion(const std::string& asked) { return !asked.empty() && asked != kNoSensor; }

/// The topic to use; empty: none of the recording's.
Result<std::string> topic_of(const MotionWanted& wanted, const std::filesystem::path& recording) {
  if (wanted.asked == kNoSensor) return std::string();
  for (const std::string& topic : wanted.topics) {
    if (topic == wanted.asked) return topic;
  }
  const std::string there = fmt::format("{}", fmt::join(wanted.topics, ", "));
  if (!wanted.asked.empty()) {
    if (wanted.topics.empty() || std::filesystem::exists(wanted.asked)) return std::string();
    return Error{fmt::format("{} {}: no such file, nor a topic of {} (there are: {})",
                             wanted.option, wanted.asked, recording.string(), there)};
  }
  if (wanted.topics.empty()) return std::string();
  if (wanted.is_mounted && wanted.topics.size() == 1) {
    log::info("{}: {} predicts motion ({} off: it does not)", recording.string(), there,
              wanted.option);
    return wanted.topics.front();
  }
  log::info("{}: {} could predict motion: say where it is with {}, and {} TOPIC",
            recording.string(), there, wanted.mounting, wanted.option);
  return std::string();
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

Result<MotionSamples> run_motion(const RunRequest& request, const Recording& recording,
                                 const ReckoningOptions& options) {
  MotionSamples samples;
  const MotionStore* const store = recording.motion.get();
  const ReckoningOptions unset;
  const std::vector<std::string> none;
  const MotionWanted imu{"--imu", request.imu, store ? store->imu_topics() : none,
                         "reckoning.T_camera_imu", options.T_camera_imu != unset.T_camera_imu};
  const Result<std::string> imu_topic = topic_of(imu, recording.place);
  if (!imu_topic) return imu_topic.error();
  if (!imu_topic->empty() || is_file_of_motion(request.imu)) {
    auto read = imu_topic->empty() ? read_imu_file(request.imu) : store->read_imu(*imu_topic);
    if (!read) return read.error();
    samples.imu = *std::move(read);
  }
  const MotionWanted wheels{"--odometry", request.odometry, store ? store->odometry_topics() : none,
                            "reckoning.T_camera_base",
                            options.T_camera_base != unset.T_camera_base};
  const Result<std::string> wheels_topic = topic_of(wheels, recording.place);
  if (!wheels_topic) return wheels_topic.error();
  if (!wheels_topic->empty() || is_file_of_motion(request.odometry)) {
    auto read = wheels_topic->empty() ? read_odometry_file(request.odometry)
                                      : store->read_odometry(*wheels_topic);
    if (!read) return read.error();
    samples.odometry = *std::move(read);
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
