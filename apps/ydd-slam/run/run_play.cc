// SPDX-License-Identifier: Apache-2.0
#include "run/run_play.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "common/progress.h"
#include "run/run_pace.h"
#include "run/untracked.h"
#include "ydd/base/cores.h"
#include "ydd/base/guard.h"
#include "ydd/base/interruption.h"
#include "ydd/base/log.h"
#include "ydd/dataset/frame_source.h"
#include "ydd/live/live_run.h"
#include "ydd/pictures/redact.h"
#include "ydd/system/motion_feed.h"

namespace ydd::app {
namespace {

std::string state_text(const FrameReport& report, const SlamSystem& system) {
  const FilteredFeatures& seen = *report.filtered;
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

/// The same complaint of another frame is of the same kind: without its file and its numbers.
std::string kind_of(const std::string& message) {
  std::string kind = message.substr(std::min(message.size(), message.find(": ")));
  std::erase_if(kind, [](unsigned char c) { return std::isdigit(c) != 0; });
  return kind;
}

/// Tells the first of each kind in full, and of the others how many there were.
class SkipWarnings {
 public:
  void add(const std::string& reason, const std::string& message) {
    if (++counts_[kind_of(message)].count > 1) return;
    counts_[kind_of(message)].first = reason;
    log::warning("{}; skipped", reason);
  }
  ~SkipWarnings() {
    for (const auto& [kind, warned] : counts_) {
      if (warned.count == 1) continue;
      log::warning("{} more frames were skipped for the same reason as {}", warned.count - 1,
                   warned.first);
    }
  }
  SkipWarnings() = default;
  SkipWarnings(const SkipWarnings&) = delete;
  SkipWarnings& operator=(const SkipWarnings&) = delete;

 private:
  struct Warned {
    int count = 0;
    std::string first;
  };
  std::map<std::string, Warned> counts_;
};

/// Decoding ahead pays where there is a core for it; at the camera's pace what is decoded ahead may
/// be dropped again.
PrefetchOptions prefetch(const RunRequest& request) {
  PrefetchOptions options;
  if (available_cores() == 1) options.workers = 0;
  if (request.realtime) options.depth = 1;
  return options;
}

constexpr std::chrono::milliseconds kWaitForCamera{100};

void tell_counts(const LiveCounts& counts) {
  std::string text = fmt::format("the camera gave {} pictures", counts.arrived);
  if (counts.dropped > 0) {
    text += fmt::format(", {} of them were dropped: tracking was slower", counts.dropped);
  }
  if (counts.unpaired > 0) text += fmt::format(", {} had no depth", counts.unpaired);
  if (counts.pauses > 0) text += fmt::format("; it paused {} times", counts.pauses);
  if (counts.unplugged > 0) text += fmt::format("; it was unplugged {} times", counts.unplugged);
  log::info("{}", text);
}

/// One pass over the sequence.
class Playback {
 public:
  Playback(const PlayInput& input, SlamSystem& system, Listeners& listeners, LiveControl* live)
      : input_(input),
        system_(system),
        listeners_(listeners),
        recorder_(listeners.recorder),
        live_(live ? std::make_unique<LiveRun>(*live, system) : nullptr),
        untracked_(input.sequence, input.camera, !input.request.map.empty()),
        progress_(input.sequence.name(), input.sequence.size(), input.request.quiet),
        pace_(input.sequence, input.camera.fps),
        motion_(input.motion) {}

  /// Until the sequence ends, a watcher or a signal ends it, or something fails.
  Result<void> run() {
    if (input_.sequence.is_live()) return look_through(*input_.sequence.recording().live);
    system_.set_patient(!input_.request.realtime);
    const std::size_t end = input_.sequence.size();
    FrameSource source(input_.sequence, input_.camera, prefetch(input_.request));
    for (std::size_t i = 0; i < end; ++i) {
      if (input_.request.realtime) i = drop_overtaken(i, source);
      if (!ready() || interruption::signal() != 0) return {};
      if (input_.request.realtime && !pace_.wait_until_due(i)) return {};
      const auto frame = source.next();
      if (!frame) break;
      if (auto r = *frame ? process_frame(**frame) : skip(i, frame->error()); !r) return r;
    }
    return {};
  }

  /// Frames of a camera, until it is enough. While it gives none, watchers and signals are heard.
  Result<void> look_through(LiveStream& camera) {
    const std::int64_t first = input_.sequence.options().first_frame;
    const std::int64_t most = input_.sequence.options().max_frames;
    Result<void> done;
    for (std::int64_t came = 0; done && (most == 0 || came < first + most);) {
      if (!ready() || interruption::signal() != 0) break;
      const auto pair = camera.next(kWaitForCamera);
      if (!pair || came++ < first) continue;
      const std::int64_t i = came - 1 - first;
      const Result<RgbdFrame> frame =
          frame_of(*pair, i, input_.camera, input_.sequence.depth_shift());
      if (!frame) return frame.error();  // so are all that follow
      done = process_frame(*frame);
    }
    const LiveCounts counts = camera.counts();
    recorder_.add_camera(counts);
    if (!input_.request.quiet) tell_counts(counts);
    return done;
  }

  /// Who interrupts a run does not want to wait for a bundle adjustment.
  Result<void> finish() {
    const bool prompt = interruption::signal() != 0;
    Result<void> finished = system_.finish(prompt ? Ending::prompt : Ending::complete);
    if (!live_) return finished;
    live_->finish();
    for (const auto& [after_frame, command] : live_->interventions()) {
      recorder_.add_command(after_frame, command);
    }
    return finished;
  }

  /// Why not one frame was tracked.
  std::string untracked_reason() const {
    return recorder_.processed() > 0 ? untracked_.reason() : first_skipped_;
  }
  /// Empty: no signal ended the run.
  std::string interrupted() const {
    const std::string name = interruption::signal_name();
    if (name.empty()) return "";
    return newest_ < 0 ? fmt::format("interrupted by {} before the first frame", name)
                       : fmt::format("interrupted by {} after frame {}", name, newest_);
  }

 private:
  /// Frames that a live camera would have overtaken by now are counted, and never decoded.
  std::size_t drop_overtaken(std::size_t i, FrameSource& source) {
    const std::size_t due = pace_.newest_due(i);
    recorder_.add_dropped(static_cast<int>(due - i));
    source.skip_to(due);
    return due;
  }

  /// False when a watcher ended the run. While it was paused, the camera's clock stood still.
  bool ready() {
    if (!live_) return true;
    const Pace::Clock::time_point before = Pace::Clock::now();
    const bool ready = live_->ready_for_frame();
    pace_.postpone(Pace::Clock::now() - before);
    return ready;
  }

  /// A frame that could be read: through the system, into the recorder, to all who listen.
  Result<void> process_frame(const RgbdFrame& frame) {
    motion_.until(frame.stamp, system_);
    Result<FrameReport> report = system_.process(frame);
    if (!report) return Error{fmt::format("frame {}: {}", frame.index, report.error().message)};
    newest_ = frame.index;
    if (listeners_.recording) record(frame);
    recorder_.add(*report, map_size(system_));
    listeners_.tracks.add(*report);
    untracked_.add(frame, *report);
    const RgbdFrame shown =
        input_.request.redact ? redacted(frame, *report, input_.catalogue) : frame;
    listeners_.moments.add(shown, *report);
    if (live_) live_->publish(shown, *report);
    progress_.update(static_cast<std::size_t>(frame.index) + 1, state_text(*report, system_));
    if (listeners_.pictures) draw(shown, *report);
    if (listeners_.foxglove) show_foxglove(shown, *report);
    return {};
  }

  /// Nor does a recording, whose disk is full.
  void record(const RgbdFrame& frame) {
    const Result<void> recorded = listeners_.recording->add(frame);
    if (recorded) return;
    log::warning("frame {}: {}; nothing more is recorded", frame.index, recorded.error().message);
    listeners_.recording_failure = recorded.error().message;
    static_cast<void>(listeners_.recording->finish());  // which fails for the same reason
    listeners_.recording.reset();
  }

  void show_foxglove(const RgbdFrame& frame, const FrameReport& report) {
    const Result<void> shown = listeners_.foxglove->add(frame, report, system_.atlas());
    if (shown) return;
    log::warning("frame {}: {}; no more for Foxglove", frame.index, shown.error().message);
    listeners_.foxglove_failure = shown.error().message;
    static_cast<void>(listeners_.foxglove->finish());
    listeners_.foxglove.reset();
  }

  /// Pictures that cannot be written do not cost the trajectory.
  void draw(const RgbdFrame& frame, const FrameReport& report) {
    Result<void> drawn = listeners_.pictures->add(frame, report, system_.atlas());
    if (drawn) return;
    log::warning("frame {}: {}; no further pictures", frame.index, drawn.error().message);
    listeners_.pictures_failure = drawn.error().message;
    listeners_.pictures.reset();
  }

  Result<void> skip(std::size_t i, const Error& error) {
    const std::string reason = fmt::format("frame {}: {}", i, error.message);
    if (input_.request.strict) return Error{reason};
    skip_warnings_.add(reason, error.message);
    if (first_skipped_.empty()) first_skipped_ = reason;
    recorder_.add_skipped(static_cast<std::int64_t>(i), error.message);
    return {};
  }

  const PlayInput& input_;
  SlamSystem& system_;
  Listeners& listeners_;
  RunRecorder& recorder_;  ///< of the listeners
  std::unique_ptr<LiveRun> live_;
  Untracked untracked_;
  Progress progress_;
  Pace pace_;
  MotionFeed motion_;
  SkipWarnings skip_warnings_;
  std::string first_skipped_;  ///< and why
  std::int64_t newest_ = -1;
};

}  // namespace

LiveScene live_scene(const PlayInput& input, bool has_detector,
                     const std::filesystem::path& folder) {
  LiveScene scene{input.sequence.name(),
                  input.sequence.size(),
                  input.camera,
                  input.catalogue,
                  StampedPoses{},
                  has_detector,
                  {}};
  const std::string& map_file = input.request.save_map;
  scene.map_file = map_file.empty() ? folder / "map.ydd" : std::filesystem::path(map_file);
  if (const auto& truth = input.sequence.groundtruth()) {
    if (Result<StampedPoses> poses = truth->read()) scene.groundtruth = *poses;
  }
  return scene;
}

PlayEnd play(const PlayInput& input, SlamSystem& system, Listeners& listeners, LiveControl* live) {
  for (const std::string& odd : odd_stamps(input.sequence, input.camera.fps)) {
    log::warning("{}: {}", input.sequence.place().string(), odd);
  }
  Playback pass(input, system, listeners, live);
  Result<void> fed = guarded("", [&] { return pass.run(); });
  const Result<void> finished = guarded("", [&] { return pass.finish(); });
  if (fed) fed = finished;
  PlayEnd end;
  end.incomplete = fed ? pass.interrupted() : "error: " + fed.error().message;
  if (!fed) {
    end.failure = fed.error().message;
  } else if (listeners.recorder.tracked() == 0 && end.incomplete.empty()) {
    const char* const what = listeners.recorder.processed() > 0 ? "was tracked" : "could be read";
    end.failure = fmt::format("{}: not one frame of {} {}: {}", input.sequence.place().string(),
                              listeners.recorder.frames_in(), what, pass.untracked_reason());
  }
  return end;
}

}  // namespace ydd::app
