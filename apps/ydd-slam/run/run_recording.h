// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "run/run_folder.h"
#include "ydd/bags/mcap_writer.h"
#include "ydd/base/background.h"
#include "ydd/geometry/camera.h"
#include "ydd/image/rgbd_frame.h"
#include "ydd/reckoning/motion_samples.h"

namespace ydd::app {

/// The frames of a run as a bag (`--record`): ROS 2's messages in MCAP, nothing of a picture lost,
/// so that the bag runs as what it was made of. Written on a thread of its own, which the run waits
/// for where the disk is slower than the camera: then the camera's queue drops, and counts.
///
/// Thread: one. The file appears when the recording is finished.
class RunRecording {
 public:
  /// Null when `file` is empty.
  static Result<std::unique_ptr<RunRecording>> open(const std::string& file, const Camera& camera);

  Result<void> add(const RgbdFrame& frame);
  /// What sensors of motion said meanwhile, at any time before the end.
  void add(const MotionSamples& samples) { motion_ = samples; }
  /// Waits for the last frame. Also after a failure what was written until then is kept.
  Result<void> finish();

 private:
  RunRecording(const std::filesystem::path& file, const Camera& camera, McapWriter writer);
  Result<void> write(const RgbdFrame& frame);  ///< on the other thread
  Result<void> write_motion();

  std::filesystem::path file_;
  Camera camera_;
  NewFolders folders_;
  McapWriter writer_;  ///< of the other thread until it has finished
  std::uint16_t colour_, info_, depth_;
  MotionSamples motion_;
  Timestamp newest_;  ///< of frames
  int frames_ = 0;
  std::unique_ptr<Background<RgbdFrame>> background_;  ///< last: stops before the others go
};

}  // namespace ydd::app
