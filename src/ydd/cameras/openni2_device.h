// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenNI.h>

#include <memory>
#include <string>
#include <vector>

#include "ydd/base/channel.h"
#include "ydd/cameras/camera_modes.h"
#include "ydd/cameras/live_pairing.h"
#include "ydd/cameras/openni2.h"

/// OpenNI2's runtime and one device of it. Inside this room only.
namespace ydd::cameras {

/// The runtime, initialised once and shut down with the last user.
class OpenNi2Runtime {
 public:
  static Result<std::shared_ptr<OpenNi2Runtime>> make();
  ~OpenNi2Runtime();
  OpenNi2Runtime(const OpenNi2Runtime&) = delete;
  OpenNi2Runtime& operator=(const OpenNi2Runtime&) = delete;

  /// A device that is plugged in.
  struct Listed {
    std::string uri, name;
  };
  std::vector<Listed> devices() const;

 private:
  OpenNi2Runtime() = default;
};

/// What the runtime complained of last, in one line: "status 1 (no devices found)".
std::string openni2_complaint(openni::Status status);

/// Modes of a sensor whose pixels are read, each once.
std::vector<CameraMode> readable_modes(const openni::SensorInfo* sensor);

/// Where pictures go from the threads of the runtime; the oldest give way.
struct PictureQueues {
  static constexpr std::size_t kWaiting = 4;
  Channel<LiveColour> colour{kWaiting};
  Channel<LiveDepth> depth{kWaiting + 2};  // so that the oldest colour still finds its partner
};

/// A device whose streams run; it stops with this.
class RunningDevice {
 public:
  /// One line of failure says what the device cannot do. `queues` must outlive this.
  static Result<std::unique_ptr<RunningDevice>> start(const std::string& uri,
                                                      const std::string& mode,
                                                      PictureQueues& queues);
  ~RunningDevice();
  RunningDevice(const RunningDevice&) = delete;
  RunningDevice& operator=(const RunningDevice&) = delete;

  const std::string& uri() const { return uri_; }
  const std::string& name() const { return name_; }
  const CameraMode& mode() const { return mode_; }
  /// By its field of view.
  Result<Camera> camera() const;

 private:
  explicit RunningDevice(PictureQueues& queues);
  Result<void> open(const std::string& uri);
  Result<void> configure(const std::string& mode);
  Result<void> play();
  Error says(const std::string& what) const;

  class ColourListener;
  class DepthListener;

  openni::Device device_;
  openni::VideoStream colour_, depth_;
  std::unique_ptr<openni::VideoStream::NewFrameListener> colour_listener_, depth_listener_;
  std::string uri_, name_;
  CameraMode mode_;
  double depth_scale_ = 1000;
};

}  // namespace ydd::cameras
