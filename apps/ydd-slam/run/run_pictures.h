// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "run/run_folder.h"
#include "run/run_job.h"
#include "ydd/base/background.h"
#include "ydd/detection/object_catalogue.h"
#include "ydd/pictures/annotate.h"
#include "ydd/pictures/map_inset.h"
#include "ydd/pictures/video_file.h"

namespace ydd::app {

/// Annotated frames as image files (--frames) and as a video (--video). They are drawn and encoded
/// on a thread of their own. With --realtime tracking never waits for them, and what they cannot
/// keep up with is left out and counted; otherwise every frame is shown.
///
/// Thread: one. What is not finished leaves no video and no empty folder.
class RunPictures {
 public:
  /// Opens what `request` asks for; null when it asks for no pictures. `catalogue` must outlive
  /// this.
  static Result<std::unique_ptr<RunPictures>> open(const RunRequest& request, const Camera& camera,
                                                   const ObjectCatalogue& catalogue);

  /// A processed frame and the map of that moment.
  Result<void> add(const RgbdFrame& frame, const FrameReport& report,
                   std::shared_ptr<const Atlas> atlas);
  /// Waits for the last picture; the video is there afterwards.
  Result<void> finish();

 private:
  struct Job {
    RgbdFrame frame;  ///< colour only
    FrameReport report;
    std::shared_ptr<const Atlas> atlas;
    double frames_per_second = 0;
  };
  RunPictures(const RunRequest& request, const ObjectCatalogue& catalogue);
  Result<void> open_video(const Camera& camera);
  double frames_per_second();
  Result<void> show(const Job& job);  ///< on the other thread

  const RunRequest request_;
  const ObjectCatalogue& catalogue_;
  NewFolders folders_;
  std::optional<VideoFile> video_;  ///< of the other thread until it has finished
  MapInset map_;                    ///< likewise
  std::uint64_t revision_ = 0;      ///< likewise; of the newest atlas
  std::deque<std::int64_t> times_ns_;
  int left_out_ = 0;
  std::unique_ptr<Background<Job>> background_;  ///< last: stops before the others go
};

}  // namespace ydd::app
