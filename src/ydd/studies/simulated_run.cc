// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/simulated_run.h"

#include <algorithm>

#include "ydd/base/interruption.h"
#include "ydd/evaluation/ate.h"
#include "ydd/system/motion_feed.h"

namespace ydd {
namespace {

/// Answers with the boxes that the caller laid out for the frame that it processes next.
class LaidOutBoxes final : public Detector {
 public:
  explicit LaidOutBoxes(std::shared_ptr<const Detections* const> boxes)
      : boxes_(std::move(boxes)) {}
  Result<Detections> detect(const RgbdFrame&) override { return **boxes_; }

 private:
  std::shared_ptr<const Detections* const> boxes_;
};

Detections boxes_of(const SimulatedFrame& frame) {
  Detections boxes;
  for (const SimulatedObject& object : frame.objects) {
    boxes.push_back({object.class_name, 1.0F, object.box});
  }
  return boxes;
}

CheckedLoop check(const LoopReport& loop, const Simulator& simulator) {
  const SE3 T_matched_current = simulator.pose(static_cast<int>(loop.matched_frame)).inverse() *
                                simulator.pose(static_cast<int>(loop.current_frame));
  const SE3 error = T_matched_current.inverse() * loop.T_matched_current;
  return {loop, error.translation().norm(), error.angle_rad()};
}

double cpu_ms_of(const FrameReport& report) {
  return report.times.empty() ? 0.0 : report.times.back().cpu_ms;
}

Result<SimulatedRun> run_frames(const Simulator& simulator,
                                const std::function<SimulatedFrame(int)>& frame_at,
                                const SystemOptions& options, const StepDone& done,
                                MotionSamples senses) {
  Detections boxes;
  const auto laid_out = std::make_shared<const Detections* const>(&boxes);
  SlamSystem system(simulator.camera(), options, ObjectCatalogue::defaults(),
                    std::make_unique<LaidOutBoxes>(laid_out));
  system.set_patient(true);
  MotionFeed motion(std::move(senses));
  SimulatedRun run;
  for (int i = 0; i < simulator.frame_count(); ++i) {
    interruption::throw_if_asked();
    const SimulatedFrame frame = frame_at(i);
    boxes = boxes_of(frame);
    motion.until(frame.frame.stamp, system);
    const Result<FrameReport> report = system.process(frame.frame);
    if (!report) return report.error();
    const auto atlas = system.atlas();
    run.truth.push_back({frame.frame.stamp, frame.T_world_camera});
    run.steps.push_back({report->track.state, report->track.T_world_camera, frame.T_world_camera,
                         cpu_ms_of(*report), atlas->keyframes().size(), atlas->points().size(),
                         report->tracks, frame.objects});
    if (done) done(i, run.steps.back());
  }
  if (auto r = system.finish(); !r) return r.error();
  run.trajectory = system.trajectory();
  run.reports = system.mapping_reports();
  run.atlas = system.atlas();
  for (const LoopReport& loop : run.reports.loops) run.loops.push_back(check(loop, simulator));
  return run;
}

}  // namespace

int SimulatedRun::lost_frames() const {
  return static_cast<int>(std::count_if(steps.begin(), steps.end(), [](const SimulatedStep& s) {
    return s.state == TrackingState::lost;
  }));
}

double SimulatedRun::ate_m() const {
  const Result<AteResult> ate = absolute_trajectory_error(truth, trajectory);
  return ate ? ate->statistics_m.rmse : -1.0;
}

Result<SimulatedRun> run_simulated(const Simulator& simulator, const SystemOptions& options,
                                   const FrameEdit& edit, const StepDone& done,
                                   MotionSamples senses) {
  const auto frame_at = [&](int i) {
    SimulatedFrame frame = simulator.render(i);
    if (edit) edit(frame);
    return frame;
  };
  return run_frames(simulator, frame_at, options, done, std::move(senses));
}

FrameStore::FrameStore(const Simulator& simulator) : simulator_(&simulator) {
  for (int i = 0; i < simulator.frame_count(); ++i) {
    interruption::throw_if_asked();
    frames_.push_back(simulator.render(i));
  }
}

Result<SimulatedRun> FrameStore::run(const SystemOptions& options) const {
  const auto frame_at = [this](int i) { return frames_[static_cast<std::size_t>(i)]; };
  return run_frames(*simulator_, frame_at, options, {}, {});
}

}  // namespace ydd
