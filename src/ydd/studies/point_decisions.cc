// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/point_decisions.h"

#include <algorithm>
#include <initializer_list>
#include <memory>
#include <string_view>
#include <utility>

#include "ydd/base/interruption.h"
#include "ydd/base/timing.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/frame_source.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/image/decode.h"
#include "ydd/sources/source.h"
#include "ydd/system/slam_system.h"

namespace ydd {
namespace {

/// The mask beside a colour image: instance of what moves at every pixel.
Result<GreyImage> load_mask(const Sequence& sequence, std::size_t i) {
  const std::filesystem::path file =
      sequence.place() / "mask" /
      (std::filesystem::path(sequence.entry(i).colour_name).stem().string() + ".png");
  const Result<ColourImage> image = load_colour(file);
  if (!image) return image.error();
  std::vector<std::uint8_t> ids;
  ids.reserve(static_cast<std::size_t>(image->width()) * static_cast<std::size_t>(image->height()));
  for (int y = 0; y < image->height(); ++y) {
    for (int x = 0; x < image->width(); ++x) ids.push_back((*image)(x, y)[0]);
  }
  return GreyImage(image->width(), image->height(), std::move(ids));
}

std::vector<Box> person_boxes(const Detections& detections) {
  static const ObjectCatalogue catalogue = ObjectCatalogue::defaults();
  std::vector<Box> boxes;
  for (const Detection& d : detections) {
    if (catalogue.is_person(d.class_name)) boxes.push_back(d.box);
  }
  return boxes;
}

/// Replays the recording; without one there is none.
Result<std::unique_ptr<Detector>> recorded_boxes(const std::filesystem::path& file) {
  if (file.empty()) return std::unique_ptr<Detector>();
  Result<DetectionRecording> recording = DetectionRecording::read(file);
  if (!recording) return recording.error();
  return std::unique_ptr<Detector>(
      std::make_unique<RecordedDetector>(std::move(*recording), file.string()));
}

SystemOptions repeatable(SystemOptions options, int latency_frames) {
  options.deterministic = true;
  if (latency_frames > 0) {
    options.detect.mode = DetectMode::asynchronous;
    options.detect.latency_frames = latency_frames;
  }
  return options;
}

double cpu_ms_of(const StageTimes& times, std::initializer_list<std::string_view> stages) {
  double sum = 0;
  for (const StageTime& t : times) {
    if (std::find(stages.begin(), stages.end(), t.stage) != stages.end()) sum += t.cpu_ms;
  }
  return sum;
}

PointQuality quality_of(const FrameReport& report, const GreyImage& mask) {
  std::vector<Keypoint> keypoints = report.filtered->kept->keypoints;
  std::vector<Rule> rules(keypoints.size(), Rule::kept);
  for (const RejectedPoint& point : report.filtered->rejected) {
    keypoints.push_back(point.keypoint);
    rules.push_back(point.rule);
  }
  return point_quality(rules, keypoints, mask, person_boxes(report.detections));
}

}  // namespace

Result<PointDecisions> decide_points(const std::filesystem::path& folder,
                                     const std::filesystem::path& detections_file,
                                     const SystemOptions& options, int latency_frames) {
  Result<Sequence> sequence = open_sequence(folder);
  if (!sequence) return sequence.error();
  const Result<Camera> camera = find_camera(sequence->recording());
  if (!camera) return camera.error();
  Result<std::unique_ptr<Detector>> boxes = recorded_boxes(detections_file);
  if (!boxes) return boxes.error();
  SlamSystem system(*camera, repeatable(options, latency_frames), ObjectCatalogue::defaults(),
                    std::move(*boxes));
  system.set_patient(true);
  PointDecisions result;
  FrameSource source(*sequence, *camera);
  for (std::size_t i = 0; auto frame = source.next(); ++i) {
    interruption::throw_if_asked();
    if (!*frame) return frame->error();
    const Result<GreyImage> mask = load_mask(*sequence, i);
    if (!mask) return mask.error();
    const Result<FrameReport> report = system.process(**frame);
    if (!report) return report.error();
    result.extract_ms.push_back(cpu_ms_of(report->times, {"features"}));
    result.judge_ms.push_back(
        cpu_ms_of(report->times, {"evidence", "dynamics", "settle_evidence"}));
    result.quality += quality_of(*report, *mask);
  }
  if (auto r = system.finish(); !r) return r.error();
  return result;
}

}  // namespace ydd
