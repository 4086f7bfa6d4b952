// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "ydd/base/result.h"
#include "ydd/live/live_control.h"

namespace ydd {

/// Where a live page is served.
struct LiveServerOptions {
  std::string address = "127.0.0.1";
  int port = 8090;    ///< 0: any that is free
  std::string token;  ///< asked of every request; empty: none, which only a loopback address may
};

/// From "8090", "ADDR", "ADDR:PORT" or "[IPV6]:PORT"; what is not named keeps its default. Fails in
/// one line on anything else, and on an address that others can reach without a token.
Result<LiveServerOptions> parse_live_address(std::string_view text, const std::string& token);

/// A web page that watches a run: annotated pictures, the map from above, state, counters,
/// commands.
///
/// Costs the run nothing: it takes the snapshots that the run publishes, and draws and encodes in
/// its own threads, each frame at most once and only when somebody asks. Few connections are served
/// at a time, further ones wait outside; a client that hangs is cut off.
///
/// Without a token only requests that name a loopback host are answered (another web site in the
/// same browser could make others), and commands must carry the header X-Ydd-Slam.
class LiveServer {
 public:
  /// Listens. `control` must outlive this. Fails in one line when the address cannot be had.
  static Result<std::unique_ptr<LiveServer>> start(LiveControl& control,
                                                   const LiveServerOptions& options);
  /// Stops: open requests end, hanging ones are cut off. When the run has ended, a page that has
  /// just asked gets that answer first, which takes a second at most.
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  int port() const;
  /// What to open in a browser, with the token.
  std::string url() const;

 private:
  class State;
  explicit LiveServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ydd
