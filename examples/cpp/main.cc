// SPDX-License-Identifier: Apache-2.0
//
// Frames in, poses out: `poses RECORDING [DETECTIONS.jsonl] > trajectory.tum`. RECORDING is
// anything that `ydd-slam run` takes; a camera of your own gives RgbdFrames to the same loop
// (docs/reference.md tells how they are made, and which headers there are).
#include <cstdio>
#include <memory>

#include "ydd/dataset/camera_file.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/sources/source.h"
#include "ydd/system/slam_system.h"

int fail(const ydd::Error& error) {
  std::fprintf(stderr, "error: %s\n", error.message.c_str());
  return 1;
}

int main(int argc, char** argv) {
  if (argc < 2) return fail({"usage: poses RECORDING [DETECTIONS.jsonl]"});
  const auto sequence = ydd::open_sequence(argv[1]);
  if (!sequence) return fail(sequence.error());
  const auto camera = ydd::find_camera(sequence->recording());
  if (!camera) return fail(camera.error());
  std::unique_ptr<ydd::Detector> detector;  // none: what moves is found all the same
  if (argc > 2) {
    auto boxes = ydd::DetectionRecording::read(argv[2]);
    if (!boxes) return fail(boxes.error());
    detector = std::make_unique<ydd::RecordedDetector>(*std::move(boxes), argv[2]);
  }

  ydd::SlamSystem slam(*camera, ydd::SystemOptions(), ydd::ObjectCatalogue::defaults(),
                       std::move(detector));
  for (std::size_t i = 0; i < sequence->size(); ++i) {
    const auto frame = sequence->read(i, *camera);
    if (!frame) return fail(frame.error());
    const auto report = slam.process(*frame);
    if (!report) return fail(report.error());
    std::fprintf(stderr, "%zu %s\n", i, std::string(to_string(report->track.state)).c_str());
  }
  if (const auto finished = slam.finish(); !finished) return fail(finished.error());
  std::fputs(format_trajectory(slam.trajectory(), ydd::TrajectoryFormat::tum).c_str(), stdout);
}
