// SPDX-License-Identifier: Apache-2.0
#include "run_feed.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include "progress.h"
#include "ydd/base/log.h"
#include "ydd/dataset/frame_source.h"
#include "ydd/viewer/live_run.h"

namespace ydd::app {
namespace {

using Clock = std::chrono::steady_clock;

/// Real-time pace: which frame is due, and waiting for it.
class Pace {
 public:
  explicit Pace(Timestamp first) : first_(first), start_(Clock::now()) {}

  void wait_until_due(Timestamp stamp) const { std::this_thread::sleep_until(due(stamp)); }
  bool is_due(Timestamp stamp) const { return Clock::now() >= due(stamp); }
  /// The camera, too, stood still for so long.
  void postpone(Clock::duration pause) { start_ += pause; }

 private:
  Clock::time_point due(Timestamp stamp) const {
    return start_ + std::chrono::nanoseconds(stamp.ns - first_.ns);
  }
  Timestamp first_;
  Clock::time_point start_;
};

std::string state_text(const FrameReport& report, const SlamSystem& system) {
  const Observations& seen = *report.observations;
  const double share = seen.extracted() == 0 ? 0.0
                                             : 100.0 * static_cast<double>(seen.rejected.size()) /
                                                   static_cast<double>(seen.extracted());
  const auto atlas = system.atlas();
  return fmt::format("{}  {} keyframes  {} points  {:.0f} % rejected",
                     to_string(report.track.state), atlas->keyframes().size(),
                     atlas->points().size(), share);
}

MapSize map_size(const SlamSystem& system) {
  const auto atlas = system.atlas();
  return {atlas->keyframes().size(), atlas->points().size()};
}

/// Whether a live camera would have overtaken frame `i` by now: then it is dropped, and counted.
bool overtaken(const Sequence& sequence, std::size_t i, std::size_t end, const Pace& pace) {
  return i + 1 < end && pace.is_due(sequence.entry(i + 1).stamp);
}

/// One pass over the sequence.
class Feed {
 public:
  Feed(const FeedInput& input, SlamSystem& system, Listeners& listeners, LiveControl* live)
      : input_(input),
        system_(system),
        listeners_(listeners),
        recorder_(listeners.recorder),
        live_(live ? std::make_unique<LiveRun>(*live, system) : nullptr),
        end_(frames_to_feed(input.sequence, input.request)),
        progress_(input.sequence.name(), end_, input.request.quiet),
        pace_(input.sequence.entry(0).stamp) {}

  Result<void> run() {
    FrameSource source(input_.sequence, input_.camera);
    for (std::size_t i = 0; i < end_; ++i) {
      const auto frame = source.next();
      if (!frame) break;
      if (input_.request.realtime && overtaken(input_.sequence, i, end_, pace_)) {
        recorder_.add_dropped(1);
        continue;
      }
      if (!ready()) break;  // after the drops: a step is a frame that is seen
      if (input_.request.realtime) pace_.wait_until_due(input_.sequence.entry(i).stamp);
      if (auto r = *frame ? feed_frame(**frame) : skip(i, frame->error()); !r) return r;
    }
    return {};
  }

  void finish() {
    system_.finish();
    if (!live_) return;
    live_->finish();
    for (const auto& [after_frame, command] : live_->interventions()) {
      recorder_.add_command(after_frame, command);
    }
  }

 private:
  /// False when a watcher ended the run. While it was paused, the camera's clock stood still.
  bool ready() {
    if (!live_) return true;
    const Clock::time_point before = Clock::now();
    const bool ready = live_->ready_for_frame();
    pace_.postpone(Clock::now() - before);
    return ready;
  }

  /// A frame that could be read: through the system, into the recorder, to all who listen.
  Result<void> feed_frame(const RgbdFrame& frame) {
    Result<FrameReport> report = system_.process(frame);
    if (!report) return report.error();
    recorder_.add(*report, map_size(system_));
    listeners_.moments.add(frame, *report);
    if (live_) live_->publish(frame, *report);
    progress_.update(static_cast<std::size_t>(frame.index) + 1, state_text(*report, system_));
    if (!listeners_.pictures) return {};
    return listeners_.pictures->add(frame, *report, system_.atlas());
  }

  Result<void> skip(std::size_t i, const Error& error) {
    const std::string reason = fmt::format("frame {}: {}", i, error.message);
    if (input_.request.strict) return Error{reason};
    log::warning("{}; skipped", reason);
    recorder_.add_skipped(static_cast<std::int64_t>(i), error.message);
    return {};
  }

  const FeedInput& input_;
  SlamSystem& system_;
  Listeners& listeners_;
  RunRecorder& recorder_;  ///< of the listeners
  std::unique_ptr<LiveRun> live_;
  std::size_t end_;
  Progress progress_;
  Pace pace_;
};

}  // namespace

std::size_t frames_to_feed(const Sequence& sequence, const RunRequest& request) {
  if (request.max_frames <= 0) return sequence.size();
  return std::min(sequence.size(), static_cast<std::size_t>(request.max_frames));
}

LiveScene live_scene(const FeedInput& input, bool has_detector,
                     const std::filesystem::path& folder) {
  LiveScene scene{input.sequence.name(),
                  frames_to_feed(input.sequence, input.request),
                  input.camera,
                  input.catalogue,
                  StampedPoses{},
                  has_detector,
                  {}};
  const std::string& map_file = input.request.save_map;
  scene.map_file = map_file.empty() ? folder / "map.ydd" : std::filesystem::path(map_file);
  if (const auto file = input.sequence.groundtruth_file()) {
    if (Result<StampedPoses> truth = read_tum_trajectory(*file)) scene.groundtruth = *truth;
  }
  return scene;
}

Result<void> feed(const FeedInput& input, SlamSystem& system, Listeners& listeners,
                  LiveControl* live) {
  Feed pass(input, system, listeners, live);
  Result<void> fed = pass.run();
  pass.finish();
  if (!fed) return fed;
  if (listeners.recorder.processed() == 0) {
    return Error{fmt::format("{}: not one frame was tracked or could be read",
                             input.sequence.folder().string())};
  }
  return {};
}

}  // namespace ydd::app
