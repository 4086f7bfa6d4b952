// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/bench.h"
#include "ydd/base/files.h"
#include "ydd/base/json_text.h"
#include "ydd/base/timing.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/frame_source.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/dynamics/judge.h"
#include "ydd/features/orb_extractor.h"
#include "ydd/image/decode.h"
#include "ydd/objects/box_carrier.h"
#include "ydd/system/system_options.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The mask beside a colour image: instance of what moves at every pixel.
Result<GreyImage> load_mask(const Sequence& sequence, std::size_t i) {
  const fs::path file =
      sequence.folder() / "mask" / (sequence.entry(i).colour_file.stem().string() + ".png");
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

}  // namespace

Result<VariantResult> judge_sequence(const BenchCase& bench_case, Variant variant,
                                     const std::vector<std::string>& set, int latency_frames) {
  Result<Sequence> sequence = Sequence::open(bench_case.folder);
  if (!sequence) return sequence.error();
  const Result<Camera> camera = find_camera(bench_case.folder);
  if (!camera) return camera.error();
  Result<DetectionRecording> recording = DetectionRecording::read(bench_case.detections);
  if (!recording) return recording.error();
  SystemOptions all;
  DynamicsOptions& options = all.dynamics;
  OptionTable options_table;
  all.describe(options_table);
  for (const std::string& assignment : set) {
    if (auto r = options_table.set_assignment(assignment, "--set"); !r) return r.error();
  }
  options.variant = variant;
  LateBoxes boxes({std::move(*recording), bench_case.detections.string()}, all.detect,
                  latency_frames);
  DynamicsJudge judge(options, ObjectCatalogue::defaults());
  OrbExtractor extractor{OrbOptions()};
  VariantResult result;
  FrameSource source(*sequence, *camera);
  for (std::size_t i = 0; auto frame = source.next(); ++i) {
    if (!*frame) return frame->error();
    const Result<GreyImage> mask = load_mask(*sequence, i);
    if (!mask) return mask.error();
    const Result<Detections> detections = boxes.next(**frame);
    if (!detections) return detections.error();
    StageTimes times;
    StageTimer extract_timer(times, "extract");
    const Features features = with_geometry(extractor.extract((*frame)->grey, judge.budget()),
                                            *camera, (*frame)->depth_m);
    extract_timer.stop();
    StageTimer judge_timer(times, "judge");
    const Judgement judgement = judge.judge(features, *detections, (*frame)->depth_m);
    judge_timer.stop();
    result.extract_ms.push_back(times[0].cpu_ms);
    result.judge_ms.push_back(times[1].cpu_ms);
    result.quality +=
        point_quality(judgement.rules, features.keypoints, *mask, person_boxes(*detections));
  }
  return result;
}

Result<std::string> bench_dynamics(const BenchRequest& request, const fs::path& scratch) {
  const Result<std::vector<BenchCase>> cases = prepare_cases(request, scratch);
  if (!cases) return cases.error();
  std::string table =
      "| sequence | variant | recall of moving points | precision | static points in person boxes "
      "kept | the same off silhouettes | decision ms, median | extraction ms |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  Json json = Json::array();
  for (const BenchCase& bench_case : *cases) {
    for (const Variant variant : {Variant::box, Variant::person, Variant::full}) {
      const Result<VariantResult> result = judge_sequence(bench_case, variant, request.set, 0);
      if (!result) return result.error();
      const PointQuality& q = result->quality;
      const double judge_ms = statistics_of(result->judge_ms).median;
      const double extract_ms = statistics_of(result->extract_ms).median;
      table += fmt::format(
          "| {} | {} | {:.1f} % | {:.1f} % | {:.1f} % | {:.1f} % | {:.3f} | {:.2f} |\n",
          bench_case.name, to_string(variant), 100 * q.recall(), 100 * q.precision(),
          100 * q.kept_in_persons(), 100 * q.kept_off_silhouettes(), judge_ms, extract_ms);
      json.push_back({{"sequence", bench_case.name},
                      {"variant", std::string(to_string(variant))},
                      {"recall", q.recall()},
                      {"precision", q.precision()},
                      {"kept_in_persons", q.kept_in_persons()},
                      {"kept_off_silhouettes", q.kept_off_silhouettes()},
                      {"decision_ms", judge_ms},
                      {"extraction_ms", extract_ms}});
    }
  }
  if (!request.out.empty()) {
    if (auto r = write_file_atomically(request.out, json_text(json, 2) + "\n"); !r)
      return r.error();
  }
  return table;
}

}  // namespace ydd::app
