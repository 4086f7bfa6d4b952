// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "ydd/base/channel.h"
#include "ydd/base/published.h"
#include "ydd/base/table.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/detection/object_catalogue.h"
#include "ydd/image/rgbd_frame.h"
#include "ydd/system/slam_system.h"

/// Between a run and those who watch it (a window, a web page): commands go in as messages, newest
/// snapshots come out. Nobody holds up tracking: a watcher that is slow misses frames.
namespace ydd {

/// What a watcher may ask of a run. It is done between two frames.
namespace live {
struct Pause {};
struct Resume {};
/// One more frame, then pause.
struct Step {};
/// Forget map and trajectory; the next frame starts afresh.
struct Reset {};
/// What is rejected from the next frame on.
struct SetVariant {
  Variant variant = Variant::full;
};
/// Whether the map is used without being changed.
struct SetLocalizationOnly {
  bool on = false;
};
/// Save the map of now to the scene's map file.
struct SaveMap {};
/// End the run after this frame; its results are written.
struct Quit {};
}  // namespace live

using LiveCommand =
    std::variant<live::Pause, live::Resume, live::Step, live::Reset, live::SetVariant,
                 live::SetLocalizationOnly, live::SaveMap, live::Quit>;

/// "pause", "resume", "step", "reset", "variant full", "localize on", "save map", "quit".
std::string to_string(const LiveCommand& command);
/// The reverse; fails in one line that tells what there is.
Result<LiveCommand> parse_live_command(std::string_view text);

/// What is remembered of every frame since the start or the last reset, for trajectories and plots.
struct LiveSample {
  std::int64_t index = 0;
  Timestamp stamp;
  TrackingState state = TrackingState::initializing;
  KeyFrameId reference;  ///< empty unless tracking
  SE3 T_reference_camera;
  int requested = 0, kept = 0, rejected = 0;  ///< features
  float total_ms = 0;                         ///< wall time of the frame
};
struct LiveSampleTag;
using LiveHistory = Table<LiveSample, LiveSampleTag>;  ///< in slot order: by time

/// How the run stands.
struct LiveStatus {
  bool paused = false;
  bool finished = false;  ///< no further frame will come
  bool localization_only = false;
  Variant variant = Variant::full;
  double frames_per_second = 0;  ///< over the last second; 0 while paused
  int resets = 0;                ///< ids of keyframes and points hold until this changes
  std::string message;           ///< one line about the last command; may be empty
};

/// The newest of a run, immutable. Copies share pixels, report, atlas and history.
struct LiveFrame {
  std::int64_t serial = 0;  ///< counts publications: a greater one is newer
  RgbdFrame frame;
  std::shared_ptr<const FrameReport> report;   ///< never null
  std::shared_ptr<const Atlas> atlas;          ///< never null
  std::shared_ptr<const LiveHistory> history;  ///< never null
  LiveStatus status;
};

/// What does not change during a run.
struct LiveScene {
  std::string sequence;
  std::size_t frames = 0;  ///< that the run will read; 0: unknown
  Camera camera;
  ObjectCatalogue catalogue;
  StampedPoses groundtruth;        ///< in a world of its own; may be empty
  bool has_detector = false;       ///< without one variants that need boxes are "off"
  std::filesystem::path map_file;  ///< that "save map" writes
};

/// Whether a run still goes on, for those who watch it.
enum class LiveEnd {
  running,
  ended,   ///< the last frame that was published is the final state
  failed,  ///< there is nothing more to look at
};

/// The two ends meet here. Thread: any, for every function.
class LiveControl {
 public:
  explicit LiveControl(LiveScene scene) : scene_(std::move(scene)) {}

  const LiveScene& scene() const { return scene_; }

  /// Watchers: asks the run for something. False when the run has ended or does not keep up.
  bool send(LiveCommand command) { return commands_.try_push(command); }
  /// Watchers: null before the first frame.
  std::shared_ptr<const LiveFrame> newest() const { return newest_.get(); }

  LiveEnd end() const {
    const auto end = end_.get();
    return end ? *end : LiveEnd::running;
  }

  /// The run: the next command, after waiting at most `wait_ms` for it.
  std::optional<LiveCommand> next_command(int wait_ms);
  /// The run: shows a frame.
  void publish(std::shared_ptr<const LiveFrame> frame) { newest_.set(std::move(frame)); }
  /// The run: takes no further command, publishes nothing more.
  void close(LiveEnd end);

 private:
  const LiveScene scene_;
  Channel<LiveCommand> commands_{64};
  Published<LiveFrame> newest_;
  Published<LiveEnd> end_;
};

}  // namespace ydd
