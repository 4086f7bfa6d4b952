// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "run/run_folder.h"
#include "run/run_job.h"
#include "ydd/bags/mcap_writer.h"
#include "ydd/base/background.h"
#include "ydd/system/slam_system.h"

namespace ydd::app {

/// What a run saw and found, for Foxglove (`--mcap`): pictures, poses, points of the map, people
/// and moving things, as they were when each frame had been worked on. Written on a thread of its
/// own; at the camera's pace tracking never waits for it, and what it cannot keep up with is left
/// out.
///
/// Thread: one. The file appears when it is finished.
class RunFoxglove {
 public:
  /// Null when the request asks for none.
  static Result<std::unique_ptr<RunFoxglove>> open(const RunRequest& request);

  Result<void> add(const RgbdFrame& frame, const FrameReport& report,
                   std::shared_ptr<const Atlas> atlas);
  /// Waits for the last frame. Also after a failure what was written until then is kept.
  Result<void> finish();

 private:
  struct Job {
    ColourImage colour;
    Timestamp stamp;
    bool has_pose = false;
    SE3 T_world_camera;
    MapId map;
    std::vector<WorldTrack> tracks;
    std::shared_ptr<const Atlas> atlas;  ///< null: its points are not due
  };
  RunFoxglove(const RunRequest& request, McapWriter writer);
  std::uint16_t channel(const char* topic, const char* schema);
  Result<void> write(const Job& job);  ///< on the other thread

  std::filesystem::path file_;
  bool drops_;
  NewFolders folders_;
  McapWriter writer_;  ///< of the other thread until it has finished
  std::uint16_t transform_, pose_, image_, points_, tracks_;
  bool begun_ = false;          ///< of the other thread
  std::int64_t points_ns_ = 0;  ///< when the points were due last
  int left_out_ = 0;
  std::unique_ptr<Background<Job>> background_;  ///< last: stops before the others go
};

}  // namespace ydd::app
