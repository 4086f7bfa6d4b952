// SPDX-License-Identifier: Apache-2.0
#ifdef YDD_HAS_openni2
#include "ydd/cameras/openni2_device.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/log.h"
#include "ydd/base/one_line.h"

namespace ydd::cameras {
namespace {

Timestamp host_now() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()};
}

/// Devices count microseconds.
Timestamp device_stamp(const openni::VideoFrameRef& frame) {
  return {static_cast<std::int64_t>(frame.getTimestamp()) * 1000};
}

/// Rows of pixels of type From, without what the stride adds; nothing when they are not there.
template <class To, class From, class Convert>
std::optional<Image<To>> pixels_of(const openni::VideoFrameRef& frame, Convert convert) {
  const int width = frame.getWidth(), height = frame.getHeight();
  const int stride = frame.getStrideInBytes();
  const auto row_size = static_cast<std::int64_t>(width) * std::int64_t{sizeof(From)};
  if (width <= 0 || height <= 0 || stride < row_size) return std::nullopt;
  if (frame.getDataSize() < static_cast<std::int64_t>(height - 1) * stride + row_size) {
    return std::nullopt;
  }
  std::vector<To> out;
  out.reserve(std::size_t(width) * std::size_t(height));
  std::vector<From> row(static_cast<std::size_t>(width));
  for (int y = 0; y < height; ++y) {
    const auto* const bytes = static_cast<const char*>(frame.getData());
    std::memcpy(row.data(), bytes + static_cast<std::ptrdiff_t>(y) * stride,
                static_cast<std::size_t>(row_size));
    for (const From& pixel : row) out.push_back(convert(pixel));
  }
  return Image<To>(width, height, std::move(out));
}

std::optional<ColourImage> colour_pixels(const openni::VideoFrameRef& frame) {
  if (frame.getVideoMode().getPixelFormat() != openni::PIXEL_FORMAT_RGB888) return std::nullopt;
  return pixels_of<Bgr, openni::RGB888Pixel>(frame, [](const openni::RGB888Pixel& p) {
    return Bgr{p.b, p.g, p.r};
  });
}

bool is_read(openni::PixelFormat format) {
  return format == openni::PIXEL_FORMAT_RGB888 || format == openni::PIXEL_FORMAT_DEPTH_1_MM ||
         format == openni::PIXEL_FORMAT_DEPTH_100_UM;
}

std::optional<RawDepthImage> depth_pixels(const openni::VideoFrameRef& frame) {
  const openni::PixelFormat format = frame.getVideoMode().getPixelFormat();
  if (!is_read(format) || format == openni::PIXEL_FORMAT_RGB888) return std::nullopt;
  return pixels_of<std::uint16_t, std::uint16_t>(frame, [](std::uint16_t count) { return count; });
}

/// Nothing: the sensor has no such mode in a format that is read. Millimetres come first.
std::optional<openni::VideoMode> video_mode(const openni::SensorInfo& sensor,
                                            const CameraMode& wanted) {
  std::optional<openni::VideoMode> out;
  const auto& modes = sensor.getSupportedVideoModes();
  for (int i = 0; i < modes.getSize(); ++i) {
    const openni::VideoMode& mode = modes[i];
    const CameraMode here{mode.getResolutionX(), mode.getResolutionY(), mode.getFps()};
    if (here != wanted || !is_read(mode.getPixelFormat())) continue;
    if (!out || mode.getPixelFormat() < out->getPixelFormat()) out = mode;
  }
  return out;
}

}  // namespace

Result<std::shared_ptr<OpenNi2Runtime>> OpenNi2Runtime::make() {
  const openni::Status status = openni::OpenNI::initialize();
  if (status != openni::STATUS_OK) {
    return Error{
        fmt::format("openni2: the library cannot be started: {}; are its drivers installed?",
                    openni2_complaint(status))};
  }
  return std::shared_ptr<OpenNi2Runtime>(new OpenNi2Runtime);
}

OpenNi2Runtime::~OpenNi2Runtime() { openni::OpenNI::shutdown(); }

std::vector<OpenNi2Runtime::Listed> OpenNi2Runtime::devices() const {
  openni::Array<openni::DeviceInfo> found;
  openni::OpenNI::enumerateDevices(&found);
  std::vector<Listed> out;
  for (int i = 0; i < found.getSize(); ++i) {
    const std::string vendor = found[i].getVendor(), name = found[i].getName();
    out.push_back({found[i].getUri(), on_one_line(vendor.empty() ? name : vendor + " " + name)});
  }
  return out;
}

std::string openni2_complaint(openni::Status status) {
  std::string text = openni::OpenNI::getExtendedError();
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  const std::size_t first = text.find_first_not_of(' ');
  const std::size_t last = text.find_last_not_of(' ');
  text = first == std::string::npos ? "" : text.substr(first, last - first + 1);
  return text.empty() ? fmt::format("status {}", static_cast<int>(status)) : on_one_line(text);
}

std::vector<CameraMode> readable_modes(const openni::SensorInfo* sensor) {
  std::vector<CameraMode> out;
  if (sensor == nullptr) return out;
  const auto& modes = sensor->getSupportedVideoModes();
  for (int i = 0; i < modes.getSize(); ++i) {
    if (!is_read(modes[i].getPixelFormat())) continue;
    out.push_back({modes[i].getResolutionX(), modes[i].getResolutionY(), modes[i].getFps()});
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());  // of several formats
  return out;
}

/// Called by threads of the runtime: takes a copy of the pixels and returns.
class RunningDevice::ColourListener : public openni::VideoStream::NewFrameListener {
 public:
  explicit ColourListener(Channel<LiveColour>& queue) : queue_(queue) {}
  void onNewFrame(openni::VideoStream& stream) override try {
    openni::VideoFrameRef frame;
    if (stream.readFrame(&frame) != openni::STATUS_OK) return;
    if (auto picture = colour_pixels(frame)) {
      queue_.push_over({device_stamp(frame), host_now(), *std::move(picture)});
    }
  } catch (const std::exception&) {  // no memory: this picture is not seen
  }

 private:
  Channel<LiveColour>& queue_;
};

class RunningDevice::DepthListener : public openni::VideoStream::NewFrameListener {
 public:
  explicit DepthListener(Channel<LiveDepth>& queue) : queue_(queue) {}
  void onNewFrame(openni::VideoStream& stream) override try {
    openni::VideoFrameRef frame;
    if (stream.readFrame(&frame) != openni::STATUS_OK) return;
    if (auto picture = depth_pixels(frame)) {
      queue_.push_over({device_stamp(frame), host_now(), *std::move(picture)});
    }
  } catch (const std::exception&) {
  }

 private:
  Channel<LiveDepth>& queue_;
};

RunningDevice::RunningDevice(PictureQueues& queues)
    : colour_listener_(std::make_unique<ColourListener>(queues.colour)),
      depth_listener_(std::make_unique<DepthListener>(queues.depth)) {}

Result<std::unique_ptr<RunningDevice>> RunningDevice::start(const std::string& uri,
                                                            const std::string& mode,
                                                            PictureQueues& queues) {
  std::unique_ptr<RunningDevice> out(new RunningDevice(queues));
  if (auto r = out->open(uri); !r) return r.error();
  if (auto r = out->configure(mode); !r) return r.error();
  if (auto r = out->play(); !r) return r.error();
  return out;
}

RunningDevice::~RunningDevice() {
  for (openni::VideoStream* const stream : {&colour_, &depth_}) {
    if (!stream->isValid()) continue;
    stream->removeNewFrameListener(stream == &colour_ ? colour_listener_.get()
                                                      : depth_listener_.get());
    stream->stop();
    stream->destroy();
  }
  device_.close();
}

Error RunningDevice::says(const std::string& what) const {
  return Error{fmt::format("openni2: '{}' ({}) {}", name_, uri_, what)};
}

Result<void> RunningDevice::open(const std::string& uri) {
  const openni::Status opened = device_.open(uri.c_str());
  if (opened != openni::STATUS_OK) {
    return Error{
        fmt::format("openni2: no camera '{}' can be opened ({}); 'ydd-slam cameras' lists "
                    "those that are plugged in",
                    uri, openni2_complaint(opened))};
  }
  uri_ = device_.getDeviceInfo().getUri();
  const std::string vendor = device_.getDeviceInfo().getVendor();
  name_ = on_one_line(vendor + (vendor.empty() ? "" : " ") + device_.getDeviceInfo().getName());
  if (device_.isFile()) return says("is a file, which is not read; record with --record instead");
  for (const auto& [sensor, what, stream] : {std::tuple(openni::SENSOR_COLOR, "colour", &colour_),
                                             std::tuple(openni::SENSOR_DEPTH, "depth", &depth_)}) {
    if (!device_.hasSensor(sensor)) return says(fmt::format("has no {}", what));
    if (const openni::Status status = stream->create(device_, sensor);
        status != openni::STATUS_OK) {
      return says(fmt::format("gives no {}: {}", what, openni2_complaint(status)));
    }
  }
  return {};
}

Result<void> RunningDevice::configure(const std::string& wanted) {
  const Result<CameraMode> mode = choose_camera_mode(
      readable_modes(&colour_.getSensorInfo()), readable_modes(&depth_.getSensorInfo()), wanted);
  if (!mode) return says(mode.error().message);
  mode_ = *mode;
  for (openni::VideoStream* const stream : {&colour_, &depth_}) {
    const auto video = video_mode(stream->getSensorInfo(), mode_);
    if (!video) return says("has lost a mode");
    if (const openni::Status status = stream->setVideoMode(*video); status != openni::STATUS_OK) {
      return says(
          fmt::format("refuses the mode {}: {}", to_string(mode_), openni2_complaint(status)));
    }
    if (video->getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_100_UM) depth_scale_ = 10'000;
    stream->setMirroringEnabled(false);
    if (stream->getMirroringEnabled()) return says("mirrors its pictures and cannot do without");
  }
  constexpr auto kToColour = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  if (!device_.isImageRegistrationModeSupported(kToColour)) {
    return says("cannot lay depth over colour (registration), which is needed");
  }
  if (const openni::Status status = device_.setImageRegistrationMode(kToColour);
      status != openni::STATUS_OK) {
    return says(fmt::format("does not lay depth over colour: {}", openni2_complaint(status)));
  }
  if (device_.setDepthColorSyncEnabled(true) != openni::STATUS_OK) {
    log::info("openni2: '{}' does not keep colour and depth in step; they are paired by time",
              name_);
  }
  return {};
}

Result<void> RunningDevice::play() {
  for (openni::VideoStream* const stream : {&depth_, &colour_}) {
    stream->addNewFrameListener(stream == &colour_ ? colour_listener_.get()
                                                   : depth_listener_.get());
    if (const openni::Status status = stream->start(); status != openni::STATUS_OK) {
      return says(fmt::format("cannot be started: {}", openni2_complaint(status)));
    }
  }
  return {};
}

Result<Camera> RunningDevice::camera() const {
  const double across_rad = colour_.getHorizontalFieldOfView();
  const double down_rad = colour_.getVerticalFieldOfView();
  Camera camera{.name = "openni2", .width_px = mode_.width_px, .height_px = mode_.height_px};
  camera.fx_px = 0.5 * mode_.width_px / std::tan(0.5 * across_rad);
  camera.fy_px = 0.5 * mode_.height_px / std::tan(0.5 * down_rad);
  camera.cx_px = 0.5 * (mode_.width_px - 1);
  camera.cy_px = 0.5 * (mode_.height_px - 1);
  camera.depth_scale = depth_scale_;
  camera.fps = mode_.fps;
  const Result<void> checked = across_rad > 0 && down_rad > 0
                                   ? check_camera(camera)
                                   : Result<void>(Error{"its field of view is 0"});
  if (!checked) {
    return says(fmt::format("does not tell its lens ({}); name a camera file with --camera",
                            checked.error().message));
  }
  return camera;
}

}  // namespace ydd::cameras
#endif
