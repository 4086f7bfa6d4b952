// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "ydd/base/result.h"
#include "ydd/live/live_control.h"

namespace ydd {

/// How the window begins, and when it ends.
struct LiveWindowOptions {
  int width_px = 1280;
  int height_px = 720;
  double most_redraws_hz = 30;              ///< fewer when nothing changes
  bool close_at_end = false;                ///< when the run has ended and its last state was drawn
  bool dense = false;                       ///< the dense cloud is shown from the start
  std::filesystem::path screenshot_at_end;  ///< window in the end; .jpg or PNG; empty: none
  std::filesystem::path screenshot_folder;  ///< where the user's screenshots go
};

/// The window of a live run. It looks at published frames only and asks for things by message:
/// neither drawing, dragging nor closing it holds up the run.
///
/// Thread: the main one (GLFW wants that) for all functions; OpenGL drivers may start more.
class LiveWindow {
 public:
  /// Fails with one line when there is no display or it knows no OpenGL 3.3. Lowers the calling
  /// thread's priority: what draws, in software perhaps, must not take time from what tracks.
  /// Threads that track are started before.
  static Result<LiveWindow> open(const LiveWindowOptions& options);
  LiveWindow(LiveWindow&&) noexcept;
  LiveWindow& operator=(LiveWindow&&) noexcept;
  ~LiveWindow();

  /// Shows the run until the user closes the window (then the run goes on, also if it was paused)
  /// or, with `close_at_end`, until it has ended. Fails when a screenshot cannot be written.
  Result<void> show(LiveControl& control);

 private:
  class Impl;
  explicit LiveWindow(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ydd
