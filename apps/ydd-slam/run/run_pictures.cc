// SPDX-License-Identifier: Apache-2.0
#include "run/run_pictures.h"

#include <utility>

#include <fmt/format.h>

#include "ydd/base/log.h"
#include "ydd/image/encode.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kWaiting = 4;  // a picture of 640x480 takes 1 MB
constexpr std::int64_t kRateWindow_ns = 1'000'000'000;

/// A corner of the picture.
ColourImage map_for(const MapInset& map, const Atlas& atlas, const ColourImage& picture) {
  return map.draw(atlas, picture.width() * 3 / 10, picture.height() * 3 / 10);
}

}  // namespace

RunPictures::RunPictures(const RunRequest& request, const ObjectCatalogue& catalogue)
    : request_(request), catalogue_(catalogue) {}

Result<std::unique_ptr<RunPictures>> RunPictures::open(const RunRequest& request,
                                                       const Camera& camera,
                                                       const ObjectCatalogue& catalogue) {
  if (request.pictures.empty() && request.video.empty()) return std::unique_ptr<RunPictures>();
  std::unique_ptr<RunPictures> out(new RunPictures(request, catalogue));
  if (!request.pictures.empty()) {
    if (auto r = out->folders_.make(request.pictures); !r) return r.error();
  }
  if (!request.video.empty()) {
    if (auto r = out->open_video(camera); !r) return r.error();
  }
  RunPictures* const self = out.get();
  out->background_ = std::make_unique<Background<Job>>(
      kWaiting, [self](const Job& job) { return self->show(job); });
  return out;
}

Result<void> RunPictures::open_video(const Camera& camera) {
  const fs::path folder = fs::path(request_.video).parent_path();
  if (!folder.empty()) {
    if (auto r = folders_.make(folder); !r) return r;
  }
  auto video = VideoFile::open(request_.video, camera.width_px, camera.height_px, camera.fps);
  if (!video) return video.error();
  video_ = *std::move(video);
  return {};
}

double RunPictures::frames_per_second() {
  times_ns_.push_back(wall_clock_ns());
  while (times_ns_.back() - times_ns_.front() > kRateWindow_ns) times_ns_.pop_front();
  const auto span_ns = times_ns_.back() - times_ns_.front();
  return span_ns > 0
             ? 1e9 * static_cast<double>(times_ns_.size() - 1) / static_cast<double>(span_ns)
             : 0;
}

Result<void> RunPictures::add(const RgbdFrame& frame, const FrameReport& report,
                              std::shared_ptr<const Atlas> atlas) {
  Job job{{frame.index, frame.stamp, {}, frame.colour, {}},
          report,
          std::move(atlas),
          frames_per_second()};
  if (!request_.realtime) return background_->push(std::move(job));
  const Result<bool> taken = background_->try_push(std::move(job));
  if (!taken) return taken.error();
  if (!*taken) ++left_out_;
  return {};
}

Result<void> RunPictures::show(const Job& job) {
  // Somebody who watched had map and trajectory forgotten: ids begin anew.
  if (job.atlas->revision() < revision_) map_ = MapInset();
  revision_ = job.atlas->revision();
  map_.add(job.report);
  const bool wanted = !request_.pictures.empty() && job.report.index % request_.pictures_every == 0;
  if (!wanted && !video_) return {};
  const ColourImage picture =
      annotate(job.frame, job.report, catalogue_,
               {job.frames_per_second, map_for(map_, *job.atlas, job.frame.colour)});
  if (wanted) {
    const fs::path file = fs::path(request_.pictures) / fmt::format("{:06d}.png", job.report.index);
    if (auto r = write_png(file, picture); !r) return r;
  }
  return video_ ? video_->add(picture) : Result<void>();
}

Result<void> RunPictures::finish() {
  if (auto r = background_->finish(); !r) return r;
  if (left_out_ > 0) {
    log::warning("{} frames have no picture: drawing did not keep the camera's pace", left_out_);
  }
  if (video_) {
    if (auto r = video_->finish(); !r) return r;
  }
  folders_.keep();
  return {};
}

}  // namespace ydd::app
