// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/point_decisions.h"

#include <memory>
#include <optional>
#include <utility>

#include "ydd/base/timing.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/frame_source.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/dynamics/evidence_rules.h"
#include "ydd/dynamics/judge.h"
#include "ydd/evidence/motion_evidence.h"
#include "ydd/features/orb_extractor.h"
#include "ydd/image/decode.h"
#include "ydd/objects/box_carrier.h"
#include "ydd/sources/source.h"

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
  static const ObjectCatalogue kCatalogue = ObjectCatalogue::defaults();
  std::vector<Box> boxes;
  for (const Detection& d : detections) {
    if (kCatalogue.is_person(d.class_name)) boxes.push_back(d.box);
  }
  return boxes;
}

/// Replays the recording; without one there is never a box.
Result<RecordedDetector> recorded_boxes(const std::filesystem::path& file) {
  if (file.empty()) {
    return RecordedDetector(DetectionRecording({}), "no boxes", {.missing_is_empty = true});
  }
  Result<DetectionRecording> recording = DetectionRecording::read(file);
  if (!recording) return recording.error();
  return RecordedDetector(std::move(*recording), file.string());
}

/// Boxes as a detector gives them that is so many frames late.
class LateBoxes {
 public:
  LateBoxes(RecordedDetector detector, const DetectOptions& options, int latency_frames)
      : detector_(std::move(detector)), carrier_(options.carry), latency_(latency_frames) {}

  Result<Detections> next(const RgbdFrame& frame) {
    if (latency_ == 0) return detector_.detect(frame);
    carrier_.advance(frame);
    if (asked_ < 0 || frame.index - asked_ >= latency_) {
      const RgbdFrame& seen = asked_ < 0 ? frame : asked_frame_;
      Result<Detections> found = detector_.detect(seen);
      if (!found) return found;
      carrier_.take(seen.index, *found);
      asked_ = frame.index;
      asked_frame_ = frame;
    }
    return carrier_.now();
  }

 private:
  RecordedDetector detector_;
  BoxCarrier carrier_;
  int latency_;
  std::int64_t asked_ = -1;
  RgbdFrame asked_frame_;
};

/// The judge with the evidence beside it that variant `evidence` asks. Nobody tracks here: how the
/// camera moves is what the evidence itself finds.
class JudgeWithEvidence {
 public:
  JudgeWithEvidence(const DynamicsOptions& options, const Camera& camera)
      : judge_(options, ObjectCatalogue::defaults()), evidence_(options.evidence, camera) {}

  int budget() const { return judge_.budget(); }

  Judgement judge(const std::shared_ptr<const Features>& features, const Detections& detections,
                  const RgbdFrame& frame) {
    if (judge_.options().variant != Variant::evidence) {
      return judge_.judge(*features, detections, frame.depth_m);
    }
    const MotionOdds odds = evidence_.look(features, frame.depth_m, frame.stamp);
    Judgement judgement = judge_.judge(*features, detections, frame.depth_m, &odds);
    evidence_.settle(std::nullopt, prior_of_cells(judgement.regions, odds));
    return judgement;
  }

 private:
  DynamicsJudge judge_;
  MotionEvidence evidence_;
};

}  // namespace

Result<PointDecisions> decide_points(const std::filesystem::path& folder,
                                     const std::filesystem::path& detections_file,
                                     const SystemOptions& options, int latency_frames) {
  Result<Sequence> sequence = open_sequence(folder);
  if (!sequence) return sequence.error();
  const Result<Camera> camera = find_camera(sequence->recording());
  if (!camera) return camera.error();
  Result<RecordedDetector> recorded = recorded_boxes(detections_file);
  if (!recorded) return recorded.error();
  LateBoxes boxes(std::move(*recorded), options.detect, latency_frames);
  JudgeWithEvidence judge(options.dynamics, *camera);
  OrbExtractor extractor(options.orb);
  PointDecisions result;
  FrameSource source(*sequence, *camera);
  for (std::size_t i = 0; auto frame = source.next(); ++i) {
    if (!*frame) return frame->error();
    const Result<GreyImage> mask = load_mask(*sequence, i);
    if (!mask) return mask.error();
    const Result<Detections> detections = boxes.next(**frame);
    if (!detections) return detections.error();
    StageTimes times;
    StageTimer extract_timer(times, "extract");
    const auto features = std::make_shared<const Features>(with_geometry(
        extractor.extract((*frame)->grey, judge.budget()), *camera, (*frame)->depth_m));
    extract_timer.stop();
    StageTimer judge_timer(times, "judge");
    const Judgement judgement = judge.judge(features, *detections, **frame);
    judge_timer.stop();
    result.extract_ms.push_back(times[0].cpu_ms);
    result.judge_ms.push_back(times[1].cpu_ms);
    result.quality +=
        point_quality(judgement.rules, features->keypoints, *mask, person_boxes(*detections));
  }
  return result;
}

}  // namespace ydd
