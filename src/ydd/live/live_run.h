// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "ydd/live/live_control.h"

namespace ydd {

/// A command that was carried out, for the run's summary: it changed what the run computed or when.
struct LiveIntervention {
  std::int64_t after_frame = -1;  ///< -1: before the first
  std::string command;
};

/// The run's end of a LiveControl: carries out commands between frames and publishes what became of
/// each frame. Thread: the one that calls SlamSystem::process.
class LiveRun {
 public:
  /// Both must outlive this.
  LiveRun(LiveControl& control, SlamSystem& system);

  /// Call before each frame: does what was asked for and waits while the run is paused. False when
  /// the run should end now.
  bool ready_for_frame();
  /// Call after each frame.
  void publish(const RgbdFrame& frame, const FrameReport& report);
  /// Call after SlamSystem::finish: shows the final map; later commands are refused.
  void finish();

  const std::vector<LiveIntervention>& interventions() const { return interventions_; }

 private:
  void carry_out(const LiveCommand& command);
  void save_map();
  void wait_while_paused();
  void remember(const FrameReport& report);
  double frames_per_second() const;
  /// Publishes the last frame again, with the state of now.
  void publish_state();

  LiveControl& control_;
  SlamSystem& system_;
  LiveFrame newest_;  ///< what was published last; its report is null before the first frame
  LiveStatus status_;
  LiveHistory history_;
  std::deque<std::int64_t> frame_times_ns_;  ///< of the last second, oldest first
  std::vector<LiveIntervention> interventions_;
  int steps_ = 0;  ///< frames still to do before pausing again
  bool quit_ = false;
};

}  // namespace ydd
