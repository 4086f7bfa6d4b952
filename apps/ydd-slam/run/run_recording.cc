// SPDX-License-Identifier: Apache-2.0
#include "run/run_recording.h"

#include <algorithm>
#include <bit>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/log.h"
#include "ydd/image/decode.h"
#include "ydd/messages/ros_writing.h"
#include "ydd/sources/camera_note.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFramesWaiting = 8;  // of 640x480: 2.5 MB each
constexpr const char* kOpticalFrame = "camera_color_optical_frame";

static_assert(std::endian::native == std::endian::little, "images are written as they lie");

McapChannel ros2_channel(const char* topic, const char* type) {
  return {topic, type, "ros2msg", std::string(ros2_definition(type)), "cdr"};
}

/// What a bag's depth counts in, and ROS.
Camera in_millimetres(Camera camera) {
  camera.depth_scale = 1000;
  return camera;
}

template <class T>
std::string image_bytes(const Image<T>& image, Timestamp stamp, std::string_view encoding) {
  const std::size_t n = std::size_t(image.width()) * std::size_t(image.height());
  ImageMessage message;
  message.stamp = stamp;
  message.frame = kOpticalFrame;
  message.width_px = static_cast<std::uint32_t>(image.width());
  message.height_px = static_cast<std::uint32_t>(image.height());
  message.encoding = encoding;
  message.step = message.width_px * static_cast<std::uint32_t>(sizeof(T));
  message.data = {reinterpret_cast<const char*>(image.data()), n * sizeof(T)};
  return write_image(message, Wire::cdr);
}

std::string imu_bytes(const ImuSample& sample) {
  ImuMessage message;
  message.stamp = sample.stamp;
  message.frame = "imu";
  message.has_turn = message.has_acceleration = true;
  for (std::size_t i = 0; i < 3; ++i) {
    message.turn_rad_s[i] = sample.gyro_rad_s[static_cast<Eigen::Index>(i)];
    message.acceleration_m_s2[i] = sample.accel_m_s2[static_cast<Eigen::Index>(i)];
  }
  return write_imu(message, Wire::cdr);
}

std::string odometry_bytes(const OdometryPose& pose) {
  const Eigen::Vector3d& t = pose.T_odom_base.translation();
  const Eigen::Quaterniond& q = pose.T_odom_base.rotation();
  OdometryMessage message;
  message.stamp = pose.stamp;
  message.frame = "odom", message.child_frame = "base_link";
  message.position_m = {t.x(), t.y(), t.z()};
  message.orientation = {q.x(), q.y(), q.z(), q.w()};
  return write_odometry(message, Wire::cdr);
}

/// Millimetres where they say it all, else metres.
std::string depth_bytes(const RgbdFrame& frame, const Camera& camera) {
  const DepthImage& depth_m = frame.depth_m;
  const RawDepthImage counts = to_raw_depth(depth_m, camera.depth_scale);
  const DepthImage again_m = to_metres(counts, camera);
  const std::size_t n = std::size_t(depth_m.width()) * std::size_t(depth_m.height());
  if (std::equal(depth_m.data(), depth_m.data() + n, again_m.data())) {
    return image_bytes(counts, frame.stamp, "16UC1");
  }
  return image_bytes(depth_m, frame.stamp, "32FC1");
}

}  // namespace

RunRecording::RunRecording(const fs::path& file, const Camera& camera, McapWriter writer)
    : file_(file),
      camera_(in_millimetres(camera)),
      writer_(std::move(writer)),
      colour_(
          writer_.add_channel(ros2_channel("/camera/color/image_raw", "sensor_msgs/msg/Image"))),
      info_(writer_.add_channel(
          ros2_channel("/camera/color/camera_info", "sensor_msgs/msg/CameraInfo"))),
      depth_(writer_.add_channel(
          ros2_channel("/camera/aligned_depth_to_color/image_raw", "sensor_msgs/msg/Image"))) {}

Result<std::unique_ptr<RunRecording>> RunRecording::open(const std::string& file,
                                                         const Camera& camera) {
  if (file.empty()) return std::unique_ptr<RunRecording>();
  if (fs::path(file).extension() != ".mcap") {
    return Error{fmt::format("--record: '{}' must end in .mcap, which is what is written", file)};
  }
  NewFolders folders;
  if (const fs::path folder = fs::path(file).parent_path(); !folder.empty()) {
    if (auto r = folders.make(folder); !r) return r.error();
  }
  Result<McapWriter> writer = McapWriter::open(file, "ros2");
  if (!writer) return writer.error();
  std::unique_ptr<RunRecording> out(new RunRecording(file, camera, *std::move(writer)));
  out->folders_ = std::move(folders);
  if (auto r = out->writer_.add_metadata(kCameraNote, camera_note(out->camera_)); !r) {
    return r.error();
  }
  RunRecording* const self = out.get();
  out->background_ = std::make_unique<Background<RgbdFrame>>(
      kFramesWaiting, [self](const RgbdFrame& frame) { return self->write(frame); });
  log::info("recording to {}, which is {} until the run ends", file,
            out->writer_.hidden_name().string());
  return out;
}

Result<void> RunRecording::add(const RgbdFrame& frame) { return background_->push(frame); }

Result<void> RunRecording::write(const RgbdFrame& frame) {
  const CameraInfoMessage info = camera_info_of(camera_, frame.stamp, kOpticalFrame);
  for (const auto& [channel, message] :
       {std::pair(colour_, image_bytes(frame.colour, frame.stamp, "bgr8")),
        std::pair(info_, write_camera_info(info, Wire::cdr)),
        std::pair(depth_, depth_bytes(frame, camera_))}) {
    if (auto r = writer_.write(channel, frame.stamp, message); !r) return r;
  }
  newest_ = frame.stamp;
  ++frames_;
  return {};
}

/// What came until the last frame: more was not heard.
Result<void> RunRecording::write_motion() {
  if (!motion_.imu.empty()) {
    const auto channel = writer_.add_channel(ros2_channel("/imu", "sensor_msgs/msg/Imu"));
    for (const ImuSample& sample : motion_.imu) {
      if (sample.stamp > newest_) break;
      if (auto r = writer_.write(channel, sample.stamp, imu_bytes(sample)); !r) return r;
    }
  }
  if (motion_.odometry.empty()) return {};
  const auto channel = writer_.add_channel(ros2_channel("/odom", "nav_msgs/msg/Odometry"));
  for (const OdometryPose& pose : motion_.odometry) {
    if (pose.stamp > newest_) break;
    if (auto r = writer_.write(channel, pose.stamp, odometry_bytes(pose)); !r) return r;
  }
  return {};
}

Result<void> RunRecording::finish() {
  Result<void> written = background_->finish();
  if (written) written = write_motion();
  const Result<void> placed = writer_.finish();
  folders_.keep();
  if (!written) return written;
  if (!placed) return placed;
  log::info("{} frames recorded in {}", frames_, file_.string());
  return {};
}

}  // namespace ydd::app
