// SPDX-License-Identifier: Apache-2.0
#include "ydd/cameras/openni2.h"

#ifndef YDD_HAS_openni2

namespace ydd {
namespace {

Error without_openni2() {
  return Error{
      "openni2: this ydd-slam was built without OpenNI2; install libopenni2-dev and build again"};
}

}  // namespace

Result<std::vector<CameraDevice>> list_openni2_cameras() { return without_openni2(); }

Result<OpenedCamera> open_openni2_camera(const std::string& /*uri*/, const std::string& /*mode*/,
                                         double /*max_difference_s*/) {
  return without_openni2();
}

}  // namespace ydd

#else

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/interruption.h"
#include "ydd/base/log.h"
#include "ydd/cameras/device_clock.h"
#include "ydd/cameras/openni2_device.h"

namespace ydd {
namespace {

using cameras::OpenNi2Runtime;
using cameras::PictureQueues;
using cameras::RunningDevice;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kLongWithoutPicture = 2s;
constexpr auto kLookAgain = 500ms;  // for a camera that is gone
constexpr auto kSlice = 20ms;       // of waiting, between looks at signals

/// Hears which devices go.
class GoneListener : public openni::OpenNI::DeviceDisconnectedListener {
 public:
  GoneListener() { openni::OpenNI::addDeviceDisconnectedListener(this); }
  ~GoneListener() { openni::OpenNI::removeDeviceDisconnectedListener(this); }
  GoneListener(const GoneListener&) = delete;
  GoneListener& operator=(const GoneListener&) = delete;

  void onDeviceDisconnected(const openni::DeviceInfo* device) override try {
    gone_.push_over(device->getUri());
  } catch (const std::exception&) {  // no memory: it is missed as a camera that gives no pictures
  }
  std::optional<std::string> next() { return gone_.try_pop(); }

 private:
  Channel<std::string> gone_{16};
};

/// A camera plugged in again may have another address: what comes before it tells the kind.
std::string kind_of_device(const std::string& uri) { return uri.substr(0, uri.find('@')); }

class OpenNi2Stream : public LiveStream {
 public:
  OpenNi2Stream(std::shared_ptr<OpenNi2Runtime> runtime, double max_difference_s)
      : runtime_(std::move(runtime)), pairing_(max_difference_s) {}

  Result<void> start(const std::string& uri, const std::string& mode) {
    auto device = RunningDevice::start(uri, mode, queues_);
    if (!device) return device.error();
    device_ = *std::move(device);
    newest_ = Clock::now();
    return {};
  }
  const RunningDevice& device() const { return *device_; }

  std::optional<LivePair> next(std::chrono::milliseconds wait) override {
    const Clock::time_point until = Clock::now() + wait;
    if (!std::exchange(asked_, true)) begin();
    do {
      watch_device();
      if (auto pair = take_pair()) return pair;
      watch_pace();
      if (!device_) {
        if (!interruption::sleep_until(std::min(until, Clock::now() + kSlice))) break;
        look_for_device();
      } else if (auto depth = queues_.depth.pop_within(kSlice)) {
        pairing_.add(*std::move(depth));
      }
    } while (Clock::now() < until && interruption::signal() == 0);
    return take_pair();
  }

  LiveCounts counts() const override {
    LiveCounts out = counts_;
    out.dropped = queues_.colour.displaced() - before_;
    out.arrived = taken_ + out.dropped;
    out.unpaired = pairing_.unpaired();
    return out;
  }

 private:
  /// What came while nobody was ready for it is no loss.
  void begin() {
    while (queues_.colour.try_pop()) continue;
    before_ = queues_.colour.displaced();
    newest_ = Clock::now();
  }

  std::optional<LivePair> take_pair() {
    while (auto depth = queues_.depth.try_pop()) pairing_.add(*std::move(depth));
    auto pair = pairing_.take();
    // One after the other, so that what is not taken yet can still give way.
    while (!pair) {
      auto colour = queues_.colour.try_pop();
      if (!colour) return std::nullopt;
      ++taken_;
      pairing_.add(*std::move(colour));
      pair = pairing_.take();
    }
    newest_ = Clock::now();
    if (pausing_) log::info("openni2: pictures come again");
    pausing_ = false;
    const Timestamp stamp = clock_.to_host(pair->colour.device, pair->colour.arrived);
    return LivePair{stamp, std::move(pair->colour.picture), std::move(pair->depth.picture)};
  }

  /// Lets go of a device that was unplugged. What it gave before is still taken.
  void watch_device() {
    while (const auto gone = gone_.next()) {
      if (!device_ || *gone != device_->uri()) continue;
      log::warning("openni2: the camera '{}' ({}) was unplugged; waiting for it", device_->name(),
                   device_->uri());
      uri_ = device_->uri();
      mode_ = to_string(device_->mode());
      device_.reset();
      unplugged_ = looked_ = Clock::now();
      ++counts_.unplugged;
    }
  }

  void watch_pace() {
    if (!device_ || pausing_ || Clock::now() - newest_ < kLongWithoutPicture) return;
    pausing_ = true;
    ++counts_.pauses;
    log::warning("openni2: no picture for {} s; waiting", kLongWithoutPicture.count());
  }

  void look_for_device() {
    if (Clock::now() - looked_ < kLookAgain) return;
    looked_ = Clock::now();
    for (const OpenNi2Runtime::Listed& listed : runtime_->devices()) {
      if (kind_of_device(listed.uri) != kind_of_device(uri_)) continue;
      if (const Result<void> started = start(listed.uri, mode_); !started) {
        if (complaint_ != started.error().message) log::warning("{}", started.error().message);
        complaint_ = started.error().message;
        continue;
      }
      pairing_.clear();
      clock_.restart();
      complaint_.clear();
      const std::chrono::duration<double> away = Clock::now() - unplugged_;
      log::info("openni2: the camera is back after {:.1f} s", away.count());
      return;
    }
  }

  std::shared_ptr<OpenNi2Runtime> runtime_;
  PictureQueues queues_;
  GoneListener gone_;
  LivePairing pairing_;
  DeviceClock clock_;
  LiveCounts counts_;
  std::int64_t taken_ = 0;  ///< colour pictures, from the queue
  std::string uri_, mode_;  ///< of the device that is gone
  std::string complaint_;   ///< of the last attempt to start it again
  Clock::time_point newest_, unplugged_, looked_;
  bool pausing_ = false;
  bool asked_ = false;                     ///< for a picture
  std::int64_t before_ = 0;                ///< pictures that gave way until then
  std::unique_ptr<RunningDevice> device_;  ///< last: it stops before the queues go
};

CameraDevice described(const OpenNi2Runtime::Listed& listed) {
  CameraDevice out{listed.uri, listed.name, {}, {}, false, {}};
  openni::Device device;
  if (const openni::Status status = device.open(listed.uri.c_str()); status != openni::STATUS_OK) {
    out.problem = cameras::openni2_complaint(status);
    return out;
  }
  out.colour = cameras::readable_modes(device.getSensorInfo(openni::SENSOR_COLOR));
  out.depth = cameras::readable_modes(device.getSensorInfo(openni::SENSOR_DEPTH));
  out.registers =
      device.isImageRegistrationModeSupported(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
  device.close();
  return out;
}

}  // namespace

Result<std::vector<CameraDevice>> list_openni2_cameras() {
  const auto runtime = OpenNi2Runtime::make();
  if (!runtime) return runtime.error();
  std::vector<CameraDevice> out;
  for (const OpenNi2Runtime::Listed& listed : (*runtime)->devices()) {
    out.push_back(described(listed));
  }
  return out;
}

Result<OpenedCamera> open_openni2_camera(const std::string& uri, const std::string& mode,
                                         double max_difference_s) {
  const auto runtime = OpenNi2Runtime::make();
  if (!runtime) return runtime.error();
  std::string chosen = uri;
  if (uri.empty()) {
    const auto devices = (*runtime)->devices();
    if (devices.empty()) {
      return Error{
          "openni2: no camera is plugged in, or none that may be opened (udev rules of its maker)"};
    }
    chosen = devices.front().uri;
    if (devices.size() > 1) {
      log::info("openni2: {} cameras; '{}' ({}) is taken", devices.size(), devices.front().name,
                chosen);
    }
  }
  auto stream = std::make_shared<OpenNi2Stream>(*runtime, max_difference_s);
  if (auto r = stream->start(chosen, mode); !r) return r.error();
  const RunningDevice& device = stream->device();
  log::info("openni2: '{}' ({}), {}", device.name(), device.uri(), to_string(device.mode()));
  return OpenedCamera{stream, device.name(), device.camera()};
}

}  // namespace ydd
#endif
