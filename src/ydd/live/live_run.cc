// SPDX-License-Identifier: Apache-2.0
#include "ydd/live/live_run.h"

#include <utility>

#include <fmt/format.h>

#include "ydd/base/interruption.h"
#include "ydd/base/timing.h"

namespace ydd {
namespace {

constexpr std::int64_t kRateWindow_ns = 1'000'000'000;
/// While paused the map may still change (a loop that is being closed): watchers see it so soon.
constexpr int kPausedWait_ms = 100;

}  // namespace

LiveRun::LiveRun(LiveControl& control, SlamSystem& system) : control_(control), system_(system) {
  status_.variant = system.variant();
}

bool LiveRun::ready_for_frame() {
  while (const auto command = control_.next_command(0)) carry_out(*command);
  wait_while_paused();
  if (steps_ > 0) --steps_;
  return !quit_;
}

void LiveRun::wait_while_paused() {
  while (status_.paused && steps_ == 0 && !quit_ && interruption::signal() == 0) {
    if (const auto command = control_.next_command(kPausedWait_ms)) {
      carry_out(*command);
    } else if (newest_.atlas && system_.atlas() != newest_.atlas) {
      publish_state();
    }
  }
}

void LiveRun::carry_out(const LiveCommand& command) {
  status_.message.clear();
  if (std::holds_alternative<live::Pause>(command)) {
    status_.paused = true;
  } else if (std::holds_alternative<live::Resume>(command)) {
    status_.paused = false;
    steps_ = 0;
  } else if (std::holds_alternative<live::Step>(command)) {
    status_.paused = true;
    ++steps_;
  } else if (std::holds_alternative<live::Reset>(command)) {
    system_.reset();
    history_ = {};
    ++status_.resets;
    status_.message = "map and trajectory forgotten";
  } else if (const auto* set = std::get_if<live::SetVariant>(&command)) {
    system_.set_variant(set->variant);
    status_.variant = set->variant;
    status_.message = fmt::format("from now on: {}", to_string(set->variant));
  } else if (const auto* localize = std::get_if<live::SetLocalizationOnly>(&command)) {
    system_.set_localization_only(localize->on);
    status_.message = localize->on ? "the map stays as it is" : "the map grows again";
  } else if (std::holds_alternative<live::SaveMap>(command)) {
    save_map();
  } else {
    quit_ = true;
  }
  interventions_.push_back({newest_.report ? newest_.report->index : -1, to_string(command)});
  publish_state();
}

void LiveRun::save_map() {
  const std::filesystem::path& file = control_.scene().map_file;
  const Result<void> saved = system_.save_map(file);
  status_.message = saved ? fmt::format("map saved to {}", file.string()) : saved.error().message;
}

void LiveRun::publish(const RgbdFrame& frame, const FrameReport& report) {
  newest_.frame = frame;
  newest_.report = std::make_shared<const FrameReport>(report);
  remember(report);
  const std::int64_t now_ns = wall_clock_ns();
  frame_times_ns_.push_back(now_ns);
  while (now_ns - frame_times_ns_.front() > kRateWindow_ns) frame_times_ns_.pop_front();
  publish_state();
}

void LiveRun::remember(const FrameReport& report) {
  LiveSample sample;
  sample.index = report.index;
  sample.stamp = report.stamp;
  sample.state = report.track.state;
  if (sample.state == TrackingState::tracking) {
    sample.reference = report.track.reference;
    sample.T_reference_camera = report.track.T_reference_camera;
  }
  sample.requested = report.requested;
  sample.kept = static_cast<int>(report.filtered->kept->size());
  sample.rejected = static_cast<int>(report.filtered->rejected.size());
  if (!report.times.empty()) sample.total_ms = static_cast<float>(report.times.back().wall_ms);
  history_.insert(sample);
}

double LiveRun::frames_per_second() const {
  if (status_.paused || status_.finished || frame_times_ns_.size() < 2) return 0;
  const auto span_ns = frame_times_ns_.back() - frame_times_ns_.front();
  return span_ns > 0
             ? 1e9 * static_cast<double>(frame_times_ns_.size() - 1) / static_cast<double>(span_ns)
             : 0;
}

void LiveRun::publish_state() {
  if (!newest_.report) return;  // nothing to show yet
  ++newest_.serial;
  newest_.atlas = system_.atlas();
  newest_.history = std::make_shared<const LiveHistory>(history_.snapshot());
  newest_.status = status_;
  newest_.status.localization_only = system_.localization_only();
  newest_.status.frames_per_second = frames_per_second();
  control_.publish(std::make_shared<const LiveFrame>(newest_));
}

void LiveRun::finish() {
  status_.finished = true;
  status_.paused = false;
  publish_state();
  control_.close(LiveEnd::ended);
}

}  // namespace ydd
