// SPDX-License-Identifier: Apache-2.0
#include "run/run_watch.h"

#include <future>
#include <memory>

#include <fmt/format.h>

#include "ydd/base/channel.h"
#include "ydd/live/live_server.h"
#ifdef YDD_HAS_WINDOW
#include "ydd/window/live_window.h"
#endif

namespace ydd::app {
namespace {

/// `play`, whose failure must not leave watchers waiting.
PlayEnd play_for_watchers(const PlayInput& input, SlamSystem& system, Listeners& listeners,
                          LiveControl& live) {
  PlayEnd end = play(input, system, listeners, &live);
  if (!end.failure.empty()) live.close(LiveEnd::failed);
  return end;
}

/// The live page, if the request wants one; null otherwise.
Result<std::unique_ptr<LiveServer>> serve(const RunRequest& request, LiveControl& live) {
  if (!request.serve) return std::unique_ptr<LiveServer>();
  const auto options = parse_live_address(*request.serve, request.serve_token);
  if (!options) return options.error();
  auto server = LiveServer::start(live, *options);
  // Also with --quiet: without it the page could not be found.
  if (server) fmt::print(stderr, "live page: {}\n", (*server)->url());
  return server;
}

#ifdef YDD_HAS_WINDOW

LiveWindowOptions window_options(const RunRequest& request, const std::filesystem::path& folder) {
  LiveWindowOptions options;
  options.most_redraws_hz = request.view.most_redraws_hz;
  options.close_at_end = request.view.close_at_end;
  options.dense = request.view.dense;
  options.screenshot_at_end = request.view.screenshot;
  options.screenshot_folder = folder;
  return options;
}

/// The window has the calling thread, as GLFW wants it; the run gets one of its own. That one is
/// started first: opening the window lowers the priority of the thread that does it.
Result<PlayEnd> play_in_window(const PlayInput& input, SlamSystem& system, Listeners& listeners,
                               LiveControl& live, const std::filesystem::path& folder) {
  Channel<bool> window_is_open(1);
  std::future<PlayEnd> played = std::async(std::launch::async, [&]() -> PlayEnd {
    if (!window_is_open.pop()) return {};
    return play_for_watchers(input, system, listeners, live);
  });
  Result<LiveWindow> window = LiveWindow::open(window_options(input.request, folder));
  if (!window) {
    window_is_open.close();
    return window.error();
  }
  if (input.request.view.paused) live.send(live::Step{});
  window_is_open.push(true);
  const Result<void> shown = window->show(live);
  PlayEnd end = played.get();
  if (!shown && end.failure.empty()) end.failure = shown.error().message;
  return end;
}

#endif

}  // namespace

Result<void> check_watchers(const RunRequest& request) {
#ifndef YDD_HAS_WINDOW
  if (request.view.window) {
    return Error{
        "--view: this ydd-slam was built without its window; install libimgui-dev, libglfw3-dev "
        "and "
        "libepoxy-dev and build again with -DYDD_BUILD_WINDOW=ON"};
  }
#endif
  if (!request.serve) return {};
  const auto options = parse_live_address(*request.serve, request.serve_token);
  return options ? Result<void>() : options.error();
}

Result<PlayEnd> play_watched(const PlayInput& input, SlamSystem& system, Listeners& listeners,
                             bool has_detector, const std::filesystem::path& folder) {
  const RunRequest& request = input.request;
  if (!request.view.window && !request.serve) return play(input, system, listeners, nullptr);
  LiveControl live(live_scene(input, has_detector, folder));
  const Result<std::unique_ptr<LiveServer>> server = serve(request, live);
  if (!server) return server.error();
#ifdef YDD_HAS_WINDOW
  if (request.view.window) return play_in_window(input, system, listeners, live, folder);
#endif
  return play_for_watchers(input, system, listeners, live);
}

}  // namespace ydd::app
