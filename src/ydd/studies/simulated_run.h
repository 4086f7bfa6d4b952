// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ydd/simulation/simulator.h"
#include "ydd/system/slam_system.h"

namespace ydd {

/// What became of one simulated frame.
struct SimulatedStep {
  TrackingState state = TrackingState::initializing;
  SE3 T_world_camera;  ///< as it was estimated then; valid when tracking
  SE3 T_true_camera;   ///< in the simulator's world
  double cpu_ms = 0;   ///< of the tracking thread
  std::size_t keyframes = 0, points = 0;
  std::vector<WorldTrack> tracks;        ///< as they were told then
  std::vector<SimulatedObject> visible;  ///< what there was to see
};

/// A loop or merge held against the truth.
struct CheckedLoop {
  LoopReport report;
  double error_m = 0, error_rad = 0;  ///< of the pose of one keyframe relative to the other
  bool is_false() const { return error_m > 0.2 || error_rad > 0.1; }
};

/// What became of a run, beside the truth.
struct SimulatedRun {
  std::vector<SimulatedStep> steps;  ///< one per frame
  std::vector<CheckedLoop> loops;
  StampedPoses trajectory, truth;
  MappingReports reports;
  std::shared_ptr<const Atlas> atlas;  ///< in the end

  int lost_frames() const;
  /// Root mean square of the trajectory error; negative if too little was tracked to tell.
  double ate_m() const;
};

/// Changes a frame before the system sees it (a hand before the lens).
using FrameEdit = std::function<void(SimulatedFrame&)>;
/// Told after every frame.
using StepDone = std::function<void(int index, const SimulatedStep& step)>;

/// Feeds a simulated camera to the system, from memory, with the exact boxes as detections, and
/// with what other senses say (`options` must know their mounting).
Result<SimulatedRun> run_simulated(const Simulator& simulator, const SystemOptions& options,
                                   const FrameEdit& edit = {}, const StepDone& done = {},
                                   MotionSamples senses = {});

/// Renders each frame once, for several runs over the same world. Keeps them all in memory.
class FrameStore {
 public:
  /// `simulator` must outlive the store.
  explicit FrameStore(const Simulator& simulator);
  /// As `run_simulated`.
  Result<SimulatedRun> run(const SystemOptions& options) const;

 private:
  const Simulator* simulator_;
  std::vector<SimulatedFrame> frames_;
};

}  // namespace ydd
