// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "bench/bench.h"
#include "common/default_detector.h"
#include "ydd/base/log.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/frame_source.h"
#include "ydd/detection/detector_config.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/simulation/simulator.h"
#include "ydd/simulation/tum_writer.h"
#include "ydd/sources/source.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

Result<fs::path> recorded_beside(const fs::path& folder, bool needed) {
  for (const char* name : {"detections.jsonl", "detections_gt.jsonl"}) {
    if (fs::exists(folder / name)) return folder / name;
  }
  if (!needed) return fs::path();
  return Error{
      fmt::format("{}: has no detections.jsonl; give --detector FILE.yaml, or record one "
                  "with 'ydd-slam detect'",
                  folder.string())};
}

/// Runs the detector over a sequence once, so that all variants get the same boxes.
Result<fs::path> record(const BenchRequest& request, const fs::path& folder, const fs::path& file) {
  Result<std::unique_ptr<Detector>> detector =
      make_detector(request.detector, request.detector_set);
  if (!detector) return detector.error();
  Result<Sequence> sequence = open_sequence(folder);
  if (!sequence) return sequence.error();
  Result<Camera> camera = find_camera(sequence->recording());
  if (!camera) return camera.error();
  log::info("{}: detecting", sequence->name());
  std::vector<RecordedFrame> frames;
  FrameSource source(*sequence, *camera);
  while (auto frame = source.next()) {
    if (!*frame) return frame->error();
    Result<Detections> detections = (*detector)->detect(**frame);
    if (!detections) return detections.error();
    RecordedFrame recorded{(*frame)->stamp, (*frame)->index, "", {}};
    for (const Detection& d : *detections) recorded.detections.push_back({.detection = d});
    frames.push_back(std::move(recorded));
  }
  if (auto r = write_recorded_detections(file, frames); !r) return r.error();
  return file;
}

/// Empty: there are none.
Result<fs::path> boxes_for(const BenchRequest& request, const fs::path& folder,
                           const fs::path& file) {
  if (request.blind()) return fs::path();
  if (request.detector.empty()) return recorded_beside(folder, request.boxes_needed);
  return record(request, folder, file);
}

Result<fs::path> simulate_busy_room(int seed, int frames, const fs::path& folder) {
  log::info("rendering busy room {}", seed);
  WorldOptions options;
  options.busy = true;
  options.path = PathKind::xyz;
  options.depth = DepthModel::kinect;
  options.seed = seed;
  options.frames = frames;
  TumWriterOptions writer;
  writer.colour_format = ColourFormat::jpeg;
  writer.jobs = 0;
  if (auto r = write_tum_sequence(Simulator(options), folder, writer); !r) return r.error();
  return folder;
}

}  // namespace

bool BenchRequest::blind() const { return detector == kNoDetector; }

std::vector<Variant> variants_of(const BenchRequest& request, std::vector<Variant> variants) {
  if (request.blind()) std::erase_if(variants, needs_boxes);
  return variants;
}

Result<std::vector<BenchCase>> prepare_cases(const BenchRequest& request, const fs::path& scratch) {
  std::vector<fs::path> folders(request.sequences.begin(), request.sequences.end());
  for (int seed = 1; seed <= request.simulated; ++seed) {
    Result<fs::path> made = simulate_busy_room(seed, request.simulated_frames,
                                               scratch / fmt::format("simulated_busy_{}", seed));
    if (!made) return made.error();
    folders.push_back(*made);
  }
  std::vector<BenchCase> cases;
  for (const fs::path& folder : folders) {
    const std::string name = fs::weakly_canonical(folder).filename().string();
    const Result<fs::path> detections = boxes_for(request, folder, scratch / (name + ".jsonl"));
    if (!detections) return detections.error();
    cases.push_back({name, folder, *detections});
  }
  return cases;
}

}  // namespace ydd::app
