// SPDX-License-Identifier: Apache-2.0
//
// A driver of OpenNI2 whose device plays frames from a file, for tests: the real runtime loads it
// from <its folder>/OpenNI2/Drivers. It mirrors, and does not lay depth over colour, until it is
// told otherwise. The file named by YDD_SIMULATED_CAMERA says what it does, a "key value" a line:
//
//   frames FILE       int32 width, height, count; then of each frame int64 microseconds, RGB,
//   uint16 repeat N          plays them N times pace_hz 20        pictures a second pause_after 10
//   stands still before that frame ... pause_ms 3000     ... for so long unplug_after 10   is
//   unplugged before that frame ... away_ms 700       ... for so long, and has then another address
//   depth_shift_us 3000  depth is so much earlier
//   no_registration 1, no_depth 1, no_sync 1, no_lens 1
#include <OpenNI.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#define XN_NEW(type, argument) new type(argument)
#define XN_DELETE(pointer) delete (pointer)
#define XN_MAX_UINT16 65535
#include <Driver/OniDriverAPI.h>

namespace {

namespace driver = oni::driver;

struct PlayedFrame {
  std::int64_t stamp_us = 0;
  std::vector<std::uint8_t> rgb;
  std::vector<std::uint16_t> depth_mm;
};

/// What the file named by YDD_SIMULATED_CAMERA says.
struct Script {
  std::map<std::string, std::string> values;
  int width = 0, height = 0;
  std::vector<PlayedFrame> frames;

  int number(const std::string& key, int otherwise) const {
    const auto found = values.find(key);
    return found == values.end() ? otherwise : std::stoi(found->second);
  }
  bool says(const std::string& key) const { return number(key, 0) != 0; }

  static Script read() {
    Script out;
    const char* const name = std::getenv("YDD_SIMULATED_CAMERA");
    if (name == nullptr) return out;
    std::ifstream text(name);
    for (std::string key, value; text >> key >> value;) out.values[key] = value;
    std::ifstream file(out.values["frames"], std::ios::binary);
    std::int32_t head[3] = {};
    file.read(reinterpret_cast<char*>(head), sizeof head);
    out.width = head[0], out.height = head[1];
    const auto n = static_cast<std::size_t>(out.width * out.height);
    for (int i = 0; i < head[2]; ++i) {
      PlayedFrame frame{0, std::vector<std::uint8_t>(3 * n), std::vector<std::uint16_t>(n)};
      file.read(reinterpret_cast<char*>(&frame.stamp_us), 8);
      file.read(reinterpret_cast<char*>(frame.rgb.data()), static_cast<std::streamsize>(3 * n));
      file.read(reinterpret_cast<char*>(frame.depth_mm.data()),
                static_cast<std::streamsize>(2 * n));
      if (file) out.frames.push_back(std::move(frame));
    }
    return out;
  }
};

void sleep_ms(int duration_ms, const std::stop_token& stop) {
  for (int i = 0; i < duration_ms / 10 && !stop.stop_requested(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

/// Copies `value` to whoever asked for a property of that size.
template <class T>
OniStatus give(const T& value, void* data, int* size) {
  if (*size < static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(T));
  *size = sizeof(T);
  return ONI_STATUS_OK;
}

class SimulatedStream : public driver::StreamBase {
 public:
  SimulatedStream(const Script& script, bool is_depth) : script_(script), is_depth_(is_depth) {
    mode_ = {is_depth ? ONI_PIXEL_FORMAT_DEPTH_1_MM : ONI_PIXEL_FORMAT_RGB888, script.width,
             script.height, 30};
  }

  OniStatus start() override { return started_ = true, ONI_STATUS_OK; }
  void stop() override { started_ = false; }
  int getRequiredFrameSize() override {
    return script_.width * script_.height * (is_depth_ ? 2 : 3);
  }

  OniBool isPropertySupported(int property) override {
    return property == ONI_STREAM_PROPERTY_VIDEO_MODE ||
           property == ONI_STREAM_PROPERTY_MIRRORING ||
           property == ONI_STREAM_PROPERTY_HORIZONTAL_FOV ||
           property == ONI_STREAM_PROPERTY_VERTICAL_FOV;
  }
  OniStatus getProperty(int property, void* data, int* size) override {
    if (property == ONI_STREAM_PROPERTY_VIDEO_MODE) return give(mode_, data, size);
    if (property == ONI_STREAM_PROPERTY_MIRRORING) {
      return give<OniBool>(mirrors_ ? TRUE : FALSE, data, size);
    }
    if (script_.says("no_lens")) return ONI_STATUS_NOT_SUPPORTED;
    if (property == ONI_STREAM_PROPERTY_HORIZONTAL_FOV) {
      return give<float>(fov_rad(script_.width), data, size);
    }
    if (property == ONI_STREAM_PROPERTY_VERTICAL_FOV) {
      return give<float>(fov_rad(script_.height), data, size);
    }
    return ONI_STATUS_NOT_SUPPORTED;
  }
  OniStatus setProperty(int property, const void* data, int) override {
    if (property == ONI_STREAM_PROPERTY_VIDEO_MODE) {
      std::memcpy(&mode_, data, sizeof mode_);
      const bool fits = mode_.resolutionX == script_.width;
      return fits ? ONI_STATUS_OK : ONI_STATUS_BAD_PARAMETER;
    }
    if (property != ONI_STREAM_PROPERTY_MIRRORING) return ONI_STATUS_NOT_SUPPORTED;
    mirrors_ = *static_cast<const OniBool*>(data) != FALSE;
    return ONI_STATUS_OK;
  }

  /// `number`: counts the frames of the device.
  void emit(const PlayedFrame& played, int number, std::int64_t stamp_us, bool registers) {
    if (!started_) return;
    OniFrame* const frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    frame->frameIndex = number;
    frame->sensorType = is_depth_ ? ONI_SENSOR_DEPTH : ONI_SENSOR_COLOR;
    frame->timestamp = static_cast<std::uint64_t>(stamp_us);
    frame->videoMode = mode_;
    frame->width = script_.width, frame->height = script_.height;
    frame->croppingEnabled = FALSE;
    frame->cropOriginX = frame->cropOriginY = 0;
    const std::size_t pixel = is_depth_ ? 2 : 3;
    frame->stride = script_.width * static_cast<int>(pixel);
    const auto* const from = is_depth_
                                 ? reinterpret_cast<const std::uint8_t*>(played.depth_mm.data())
                                 : played.rgb.data();
    auto* const to = static_cast<std::uint8_t*>(frame->data);
    frame->dataSize = frame->stride * script_.height;
    for (int y = 0; y < script_.height; ++y) {
      for (int x = 0; x < script_.width; ++x) {
        // What is not registered is seen from elsewhere.
        const int seen = is_depth_ && !registers ? (x + script_.width / 2) % script_.width : x;
        const int source = mirrors_ ? script_.width - 1 - seen : seen;
        std::memcpy(to + (static_cast<std::size_t>(y * script_.width + x)) * pixel,
                    from + (static_cast<std::size_t>(y * script_.width + source)) * pixel, pixel);
      }
    }
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }

 private:
  /// Of a lens with 535.4 px in a picture of 640: that of simulated rooms.
  float fov_rad(int size_px) const {
    const float focal_px = 535.4F * static_cast<float>(script_.width) / 640.0F;
    return 2 * std::atan(0.5F * static_cast<float>(size_px) / focal_px);
  }

  const Script& script_;
  bool is_depth_;
  OniVideoMode mode_{};
  std::atomic<bool> mirrors_{true};
  std::atomic<bool> started_{false};
};

class SimulatedDevice : public driver::DeviceBase {
 public:
  /// `unplug`: what happens when it is pulled out.
  SimulatedDevice(const Script& script, int first, std::function<void(int)> unplug)
      : script_(script), unplug_(std::move(unplug)) {
    const int w = script.width, h = script.height;
    colour_modes_ = {{ONI_PIXEL_FORMAT_RGB888, w, h, 30},
                     {ONI_PIXEL_FORMAT_YUV422, 2 * w, 2 * h, 30},
                     {ONI_PIXEL_FORMAT_RGB888, 2 * w, 2 * h, 15}};
    depth_modes_ = {{ONI_PIXEL_FORMAT_DEPTH_100_UM, w, h, 30},
                    {ONI_PIXEL_FORMAT_DEPTH_1_MM, w, h, 30},
                    {ONI_PIXEL_FORMAT_DEPTH_1_MM, w / 2, h / 2, 30}};
    sensors_.push_back(
        {ONI_SENSOR_COLOR, static_cast<int>(colour_modes_.size()), colour_modes_.data()});
    if (!script.says("no_depth")) {
      sensors_.push_back(
          {ONI_SENSOR_DEPTH, static_cast<int>(depth_modes_.size()), depth_modes_.data()});
    }
    thread_ = std::jthread([this, first](const std::stop_token& stop) { play(first, stop); });
  }

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_.data();
    *count = static_cast<int>(sensors_.size());
    return ONI_STATUS_OK;
  }
  driver::StreamBase* createStream(OniSensorType sensor) override {
    auto* const stream = new SimulatedStream(script_, sensor == ONI_SENSOR_DEPTH);
    const std::lock_guard lock(mutex_);
    (sensor == ONI_SENSOR_DEPTH ? depth_ : colour_) = stream;
    return stream;
  }
  void destroyStream(driver::StreamBase* stream) override {
    const std::lock_guard lock(mutex_);
    if (stream == depth_) depth_ = nullptr;
    if (stream == colour_) colour_ = nullptr;
    delete stream;
  }

  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    return mode == ONI_IMAGE_REGISTRATION_OFF || !script_.says("no_registration");
  }
  OniBool isPropertySupported(int property) override {
    return property == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION;
  }
  OniStatus setProperty(int property, const void* data, int) override {
    if (property != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_SUPPORTED;
    registers_ = *static_cast<const OniImageRegistrationMode*>(data) ==
                 ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
    return ONI_STATUS_OK;
  }

 private:
  void play(int first, const std::stop_token& stop) {
    const int count = static_cast<int>(script_.frames.size()) * script_.number("repeat", 1);
    const auto period = std::chrono::microseconds(1'000'000 / script_.number("pace_hz", 20));
    while (!stop.stop_requested() && !both_run()) std::this_thread::sleep_for(period);
    for (int i = first; i < count && !stop.stop_requested(); ++i) {
      if (i == script_.number("unplug_after", -1) && i != first) return unplug_(i);
      if (i == script_.number("pause_after", -1)) {
        sleep_ms(script_.number("pause_ms", 0), stop);
      }
      const PlayedFrame& frame =
          script_.frames[static_cast<std::size_t>(i) % script_.frames.size()];
      // A clock that started with the device, a while ago.
      const std::int64_t stamp_us = 1'234'567 + (i - first) * std::int64_t{33'333};
      {
        const std::lock_guard lock(mutex_);
        if (depth_)
          depth_->emit(frame, i, stamp_us - script_.number("depth_shift_us", 0), registers_);
        if (colour_) colour_->emit(frame, i, stamp_us, registers_);
      }
      std::this_thread::sleep_for(period);
    }
  }
  bool both_run() {
    const std::lock_guard lock(mutex_);
    return colour_ != nullptr && depth_ != nullptr;
  }

  const Script& script_;
  std::function<void(int)> unplug_;
  std::vector<OniVideoMode> colour_modes_, depth_modes_;
  std::vector<OniSensorInfo> sensors_;
  std::atomic<bool> registers_{false};
  std::mutex mutex_;
  SimulatedStream* colour_ = nullptr;
  SimulatedStream* depth_ = nullptr;
  std::jthread thread_;  ///< last: joined before the streams go
};

class SimulatedDriver : public driver::DriverBase {
 public:
  explicit SimulatedDriver(OniDriverServices* services)
      : DriverBase(services), script_(Script::read()) {}

  OniStatus initialize(driver::DeviceConnectedCallback connected,
                       driver::DeviceDisconnectedCallback disconnected,
                       driver::DeviceStateChangedCallback state, void* cookie) override {
    DriverBase::initialize(connected, disconnected, state, cookie);
    if (!script_.frames.empty()) plug_in("simulated@1");
    return ONI_STATUS_OK;
  }

  driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    if (uri != std::string(info_.uri)) return nullptr;
    return new SimulatedDevice(script_, next_frame_, [this](int frame) { unplug(frame); });
  }
  void deviceClose(driver::DeviceBase* device) override { delete device; }
  void shutdown() override { thread_ = {}; }

 private:
  void plug_in(const std::string& uri) {
    info_ = {};
    std::strncpy(info_.uri, uri.c_str(), sizeof info_.uri - 1);
    std::strncpy(info_.vendor, "Ydd", sizeof info_.vendor - 1);
    std::strncpy(info_.name, "Simulated", sizeof info_.name - 1);
    deviceConnected(&info_);
  }
  /// Called by the device's own thread, which then ends.
  void unplug(int frame) {
    next_frame_ = frame;
    deviceDisconnected(&info_);
    thread_ = std::jthread([this](const std::stop_token& stop) {
      sleep_ms(script_.number("away_ms", 500), stop);
      if (!stop.stop_requested()) plug_in("simulated@2");
    });
  }

  // Both sides of a runtime that was asked for frame sync.
  void* enableFrameSync(driver::StreamBase**, int) override {
    return script_.says("no_sync") ? nullptr : this;
  }

  Script script_;
  OniDeviceInfo info_{};
  int next_frame_ = 0;
  std::jthread thread_;
};

}  // namespace

ONI_EXPORT_DRIVER(SimulatedDriver)
