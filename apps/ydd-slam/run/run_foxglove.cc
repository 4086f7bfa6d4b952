// SPDX-License-Identifier: Apache-2.0
#include "run/run_foxglove.h"

#include <utility>

#include <fmt/format.h>

#include "ydd/base/log.h"
#include "ydd/image/jpeg_codec.h"
#include "ydd/pictures/foxglove_messages.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kJobsWaiting = 4;
constexpr std::int64_t kPointsEvery_ns = 1'000'000'000;
constexpr std::size_t kMostPoints = 20'000;
constexpr int kJpegQuality = 80;

}  // namespace

RunFoxglove::RunFoxglove(const RunRequest& request, McapWriter writer)
    : file_(request.mcap),
      drops_(request.realtime),
      writer_(std::move(writer)),
      transform_(channel("/tf", "foxglove.FrameTransform")),
      pose_(channel("/pose", "foxglove.PoseInFrame")),
      image_(channel("/image", "foxglove.CompressedImage")),
      points_(channel("/points", "foxglove.PointCloud")),
      tracks_(channel("/tracks", "foxglove.SceneUpdate")) {}

std::uint16_t RunFoxglove::channel(const char* topic, const char* schema) {
  return writer_.add_channel(
      {topic, schema, "jsonschema", std::string(foxglove::schema_of(schema)), "json"});
}

Result<std::unique_ptr<RunFoxglove>> RunFoxglove::open(const RunRequest& request) {
  if (request.mcap.empty()) return std::unique_ptr<RunFoxglove>();
  const fs::path file = request.mcap;
  if (file.extension() != ".mcap") {
    return Error{fmt::format("--mcap: '{}' must end in .mcap", request.mcap)};
  }
  NewFolders folders;
  if (!file.parent_path().empty()) {
    if (auto r = folders.make(file.parent_path()); !r) return r.error();
  }
  Result<McapWriter> writer = McapWriter::open(file, "");
  if (!writer) return writer.error();
  std::unique_ptr<RunFoxglove> out(new RunFoxglove(request, *std::move(writer)));
  out->folders_ = std::move(folders);
  RunFoxglove* const self = out.get();
  out->background_ = std::make_unique<Background<Job>>(
      kJobsWaiting, [self](const Job& job) { return self->write(job); });
  return out;
}

Result<void> RunFoxglove::add(const RgbdFrame& frame, const FrameReport& report,
                              std::shared_ptr<const Atlas> atlas) {
  const TrackResult& track = report.track;
  Job job{frame.colour, frame.stamp, track.reference.valid(), track.T_world_camera, {},
          {},           nullptr};
  if (job.has_pose) {
    job.map = atlas->map_of(track.reference);
    job.tracks = report.tracks;
    if (frame.stamp.ns - points_ns_ >= kPointsEvery_ns) {
      points_ns_ = frame.stamp.ns;
      job.atlas = std::move(atlas);
    }
  }
  if (!drops_) return background_->push(std::move(job));
  const Result<bool> taken = background_->try_push(std::move(job));
  if (!taken) return taken.error();
  if (!*taken) ++left_out_;
  return {};
}

Result<void> RunFoxglove::write(const Job& job) {
  const auto put = [&](std::uint16_t channel, const std::string& message) {
    return writer_.write(channel, job.stamp, message);
  };
  if (!std::exchange(begun_, true)) {
    const std::string up =
        foxglove::frame_transform(job.stamp, "map", "world", foxglove::world_in_map());
    if (auto r = put(transform_, up); !r) return r;
  }
  const Result<std::string> jpeg = encode_jpeg(job.colour, kJpegQuality);
  if (!jpeg) return jpeg.error();
  if (auto r = put(image_, foxglove::compressed_image(job.stamp, *jpeg)); !r) return r;
  if (auto r = put(tracks_, foxglove::scene_update(job.stamp, job.tracks)); !r) return r;
  if (!job.has_pose) return {};
  const std::string moved =
      foxglove::frame_transform(job.stamp, "world", "camera", job.T_world_camera);
  if (auto r = put(transform_, moved); !r) return r;
  if (auto r = put(pose_, foxglove::pose_in_frame(job.stamp, job.T_world_camera)); !r) return r;
  if (!job.atlas) return {};
  return put(points_, foxglove::point_cloud(job.stamp, *job.atlas, job.map, kMostPoints));
}

Result<void> RunFoxglove::finish() {
  const Result<void> written = background_->finish();
  const Result<void> placed = writer_.finish();
  folders_.keep();
  if (!written) return written;
  if (!placed) return placed;
  if (left_out_ > 0) {
    log::warning("{} frames are not in {}: writing did not keep the camera's pace", left_out_,
                 file_.string());
  }
  return {};
}

}  // namespace ydd::app
