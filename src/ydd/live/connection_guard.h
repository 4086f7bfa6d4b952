// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <utility>

namespace ydd {

/// Cuts off clients that would keep one of the few workers of a server, or its memory, for
/// themselves. The server's library knows only how long a client may be silent; one that sends a
/// letter a second, or an endless header, would stay.
///
/// A connection is cut when it has sent more than any request can have, and when its request is not
/// complete after a while: a short one while others wait, a longer one else. Once its request
/// is known it may take its time to fetch the answer, half a minute of it while others wait.
///
/// Has no thread and no lock of its own.
class ConnectionGuard {
 public:
  using Clock = std::chrono::steady_clock;
  /// Numeric address and port of the other side.
  using Peer = std::pair<std::string, int>;

  /// The request of `peer` has been read.
  void asked(const Peer& peer);
  /// `peer` has its answer; its port may come again with another connection.
  void answered(const Peer& peer);
  /// Looks at the connections to the server's own `port`. `crowded`: others wait for a worker.
  void sweep(int port, Clock::time_point now, bool crowded);

 private:
  struct Connection {
    Clock::time_point since;
    bool asked = false, idle = false, seen = true;
  };
  bool is_over(int fd, Connection& connection, Clock::time_point now, bool crowded) const;

  std::map<Peer, Connection> connections_;
};

/// Ends all connections to this process's own `port`: their readers wake up.
void cut_off_clients(int port);

}  // namespace ydd
