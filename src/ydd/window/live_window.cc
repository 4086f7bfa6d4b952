// SPDX-License-Identifier: Apache-2.0
#include "ydd/window/live_window.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include "ydd/base/interruption.h"
#include "ydd/base/log.h"
#include "ydd/base/timing.h"
#include "ydd/image/encode.h"
#include "ydd/pictures/annotate.h"
#include "ydd/viewer/window_layout.h"
#include "ydd/window/glfw_window.h"
#include "ydd/window/map_view.h"
#include "ydd/window/panels.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kChartFrames = 240;
/// After the user did something panels still fade and follow: so long it is drawn as if he did.
constexpr std::int64_t kAfterglow_ns = 400'000'000;
constexpr int kNice = 10;
/// ImGui needs a few passes until its windows have their sizes.
constexpr int kSettle = 4;

double seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

std::vector<LiveSample> newest_samples(const LiveHistory& history) {
  std::vector<LiveSample> samples;
  const std::size_t skip = history.size() > kChartFrames ? history.size() - kChartFrames : 0;
  std::size_t seen = 0;
  history.for_each([&](auto, const LiveSample& sample) {
    if (seen++ >= skip) samples.push_back(sample);
  });
  return samples;
}

gl::Viewport viewport_of(const PixelRect& r, int window_height_px) {
  return {r.x, window_height_px - r.bottom(), r.width, r.height};
}

}  // namespace

class LiveWindow::Impl {
 public:
  Impl(const LiveWindowOptions& options, GlfwWindow window)
      : options_(options), window_(std::move(window)) {
    state_.dense = options.dense;
  }

  Result<void> show(LiveControl& control) {
    last_input_ns_ = wall_clock_ns();
    while (!window_.closing() && control.end() != LiveEnd::failed && !interrupted(control)) {
      const bool input = window_.wait_for_input(seconds_to_next_redraw());
      const std::int64_t now_ns = wall_clock_ns();
      if (input) last_input_ns_ = now_ns;
      if (seconds_to_next_redraw() > 0) continue;
      const bool fresh = take_newest(control);
      if (!fresh && !lively_ && now_ns - last_input_ns_ > kAfterglow_ns) {
        drawn_ns_ = now_ns;  // nothing new: look again when the next redraw would be due
        if (done(control)) break;
        continue;
      }
      redraw(control, now_ns);
    }
    control.send(live::Resume{});
    return finish_screenshot();
  }

 private:
  double seconds_to_next_redraw() const {
    const double period_s = 1.0 / options_.most_redraws_hz;
    return std::clamp(period_s - seconds(wall_clock_ns() - drawn_ns_), 0.0, period_s);
  }

  bool at_end() const { return live_ && live_->status.finished; }
  /// Somebody at the terminal does not want to look any longer; the run itself ends first.
  static bool interrupted(const LiveControl& control) {
    return interruption::signal() != 0 && control.end() != LiveEnd::running;
  }
  /// Asked when nothing is left to draw. A run that ended without a frame is done, too.
  bool done(const LiveControl& control) const {
    return options_.close_at_end && control.end() == LiveEnd::ended && (at_end() || !live_);
  }

  bool take_newest(LiveControl& control) {
    auto newest = control.newest();
    if (!newest || (newest == live_ && !map_.stale())) return false;
    const bool new_picture = !live_ || newest->report != live_->report;
    live_ = std::move(newest);
    if (new_picture) {
      picture_.upload(annotate(live_->frame, *live_->report, control.scene().catalogue));
    }
    map_.show(live_, control.scene(), state_);
    gather_facts(control.scene());
    return true;
  }

  void gather_facts(const LiveScene& scene) {
    facts_.live = live_;
    facts_.recent = newest_samples(*live_->history);
    facts_.frames = scene.frames;
    facts_.sequence = scene.sequence;
    facts_.has_detector = scene.has_detector;
    facts_.has_truth = !scene.groundtruth.empty();
    facts_.keyframes = map_.scene().keyframe_count;
    facts_.points = map_.scene().point_count;
    facts_.maps = map_.scene().maps;
    facts_.loops = static_cast<int>(map_.scene().loops.size() / 2);
    facts_.error_rmse_m = map_.scene().error_rmse_m;
  }

  void redraw(LiveControl& control, std::int64_t now_ns) {
    const double elapsed_s = std::min(0.5, seconds(now_ns - std::exchange(drawn_ns_, now_ns)));
    const auto [width_px, height_px] = window_.size();
    if (width_px == 0 || height_px == 0) return;  // minimised
    const double aspect =
        live_ ? static_cast<double>(picture_.width()) / std::max(1, picture_.height()) : 4.0 / 3;
    const WindowLayout layout = layout_window(width_px, height_px, aspect);
    window_.begin_frame();
    const PanelRequests requests = live_ ? draw_parts(layout) : draw_waiting();
    lively_ = live_ && map_.animate(state_.eye, elapsed_s);
    if (live_ && state_.tracks) {
      const double map_aspect = static_cast<double>(layout.map.width) / layout.map.height;
      draw_labels(layout.map, map_.labels(map_aspect));
    }
    if (at_end() && ++end_redraws_ < kSettle) lively_ = true;
    gl::clear_window(width_px, height_px);
    if (live_) map_.draw(viewport_of(layout.map, height_px), state_);
    window_.draw_panels();
    carry_out(requests, control);
    take_screenshots(requests, width_px, height_px);
    window_.present();
  }

  PanelRequests draw_parts(const WindowLayout& layout) {
    PanelRequests requests;
    for (const char key : window_.take_keys()) take_key(key, facts_, state_, requests);
    draw_toolbar(layout.toolbar, facts_, state_, requests);
    draw_picture(layout.picture, picture_);
    draw_charts(layout.charts, facts_);
    const MapGesture gesture = draw_map_overlay(layout.map, facts_, state_, facts_.loops > 0);
    apply(gesture, layout.map.height);
    return requests;
  }

  PanelRequests draw_waiting() {
    ImGui::Begin("waiting", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::TextUnformatted("Waiting for the first frame ...");
    ImGui::End();
    return {};
  }

  void apply(const MapGesture& gesture, int map_height_px) {
    map_.turn(gesture.orbit_x, gesture.orbit_y);
    map_.zoom(gesture.zoom_steps);
    if (gesture.pan_x == 0 && gesture.pan_y == 0) return;
    map_.pan(gesture.pan_x, gesture.pan_y, map_height_px);
    state_.eye = EyeMode::free;  // who moves the target wants it to stay
  }

  void carry_out(const PanelRequests& requests, LiveControl& control) {
    for (const LiveCommand& command : requests.commands) control.send(command);
    if (requests.close) window_.close();
    if (!requests.fit) return;
    map_.fit();
    state_.eye = EyeMode::free;
    last_input_ns_ = wall_clock_ns();
  }

  void take_screenshots(const PanelRequests& requests, int width_px, int height_px) {
    if (requests.screenshot) save_screenshot(gl::read_window(width_px, height_px));
    const bool wanted = !options_.screenshot_at_end.empty() && end_picture_.empty();
    if (wanted && at_end() && !lively_) end_picture_ = gl::read_window(width_px, height_px);
  }

  /// Into the run's folder; a disk that is full must not end the run.
  void save_screenshot(const ColourImage& picture) const {
    const fs::path file =
        options_.screenshot_folder / fmt::format("view-{:06d}.png", live_->report->index);
    if (auto r = write_png(file, picture); !r) {
      log::warning("{}", r.error().message);
    } else {
      log::info("screenshot: {}", file.string());
    }
  }

  Result<void> finish_screenshot() const {
    if (options_.screenshot_at_end.empty() || end_picture_.empty()) return {};
    const fs::path& file = options_.screenshot_at_end;
    return file.extension() == ".jpg" ? write_jpeg(file, end_picture_)
                                      : write_png(file, end_picture_);
  }

  LiveWindowOptions options_;
  GlfwWindow window_;  // its context outlives everything below
  ViewState state_;
  gl::Texture picture_;
  MapView map_;
  PanelFacts facts_;
  std::shared_ptr<const LiveFrame> live_;
  ColourImage end_picture_;
  std::int64_t drawn_ns_ = 0;
  std::int64_t last_input_ns_ = 0;
  bool lively_ = false;  ///< something on the screen still moves
  int end_redraws_ = 0;
};

LiveWindow::LiveWindow(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LiveWindow::LiveWindow(LiveWindow&&) noexcept = default;
LiveWindow& LiveWindow::operator=(LiveWindow&&) noexcept = default;
LiveWindow::~LiveWindow() = default;

Result<LiveWindow> LiveWindow::open(const LiveWindowOptions& options) {
  // Of this thread alone, says Linux; threads that it starts (a software renderer's) inherit it.
  if (::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNice) != 0) {
    log::debug("the window's priority could not be lowered");
  }
  Result<GlfwWindow> window = GlfwWindow::open(options.width_px, options.height_px, "ydd-slam");
  if (!window) return window.error();
  return LiveWindow(std::make_unique<Impl>(options, std::move(*window)));
}

Result<void> LiveWindow::show(LiveControl& control) { return impl_->show(control); }

}  // namespace ydd
