// SPDX-License-Identifier: Apache-2.0
#include "ydd/live/connection_guard.h"

#include <dirent.h>
#include <linux/tcp.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <array>
#include <charconv>
#include <string_view>

namespace ydd {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPatience{3000}, kPatienceInACrowd{400}, kPatienceWithAnswers{30'000};
constexpr std::uint64_t kLongestRequest = std::uint64_t{128} << 10;

/// Calls `take(fd, peer)` for each connection to the own `port`.
template <class Take>
void for_each_client(int port, Take take) {
  DIR* const folder = ::opendir("/proc/self/fd");
  if (!folder) return;
  while (const dirent* const entry = ::readdir(folder)) {
    const std::string_view name = entry->d_name;
    int fd = -1;
    if (std::from_chars(name.begin(), name.end(), fd).ptr != name.end()) continue;
    sockaddr_storage local{}, peer{};
    socklen_t local_size = sizeof(local), peer_size = sizeof(peer);
    if (::getsockname(fd, reinterpret_cast<sockaddr*>(&local), &local_size) != 0) continue;
    if (::getpeername(fd, reinterpret_cast<sockaddr*>(&peer), &peer_size) != 0) continue;
    // Both families keep the port in the same place.
    const auto port_of = [](const sockaddr_storage& address) {
      return ntohs(reinterpret_cast<const sockaddr_in*>(&address)->sin_port);
    };
    const bool internet = local.ss_family == AF_INET || local.ss_family == AF_INET6;
    if (!internet || port_of(local) != port) continue;
    std::array<char, NI_MAXHOST> host{};
    ::getnameinfo(reinterpret_cast<const sockaddr*>(&peer), peer_size, host.data(), host.size(),
                  nullptr, 0, NI_NUMERICHOST);
    take(fd, ConnectionGuard::Peer{host.data(), port_of(peer)});
  }
  ::closedir(folder);
}

std::uint64_t bytes_received(int fd) {
  tcp_info info{};
  socklen_t size = sizeof(info);
  return ::getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 ? info.tcpi_bytes_received : 0;
}

/// What has come in and waits for a worker to read it.
bool has_unread_bytes(int fd) {
  int count = 0;
  return ::ioctl(fd, FIONREAD, &count) == 0 && count > 0;
}

}  // namespace

void ConnectionGuard::asked(const Peer& peer) {
  connections_.try_emplace(peer, Connection{Clock::now()}).first->second.asked = true;
}

void ConnectionGuard::answered(const Peer& peer) { connections_.erase(peer); }

bool ConnectionGuard::is_over(int fd, Connection& connection, Clock::time_point now,
                              bool crowded) const {
  if (bytes_received(fd) > kLongestRequest) return true;
  if (connection.asked) return crowded && now - connection.since > kPatienceWithAnswers;
  const bool late = now - connection.since > (crowded ? kPatienceInACrowd : kPatience);
  // Unread bytes: it waits for a worker, not the worker for it. What a worker has just read may be
  // a whole request, which is known at the next sweep.
  const bool was_idle = connection.idle;
  connection.idle = !has_unread_bytes(fd);
  return late && was_idle && connection.idle;
}

void ConnectionGuard::sweep(int port, Clock::time_point now, bool crowded) {
  for (auto& [peer, connection] : connections_) connection.seen = false;
  for_each_client(port, [&](int fd, const Peer& peer) {
    Connection& connection = connections_.try_emplace(peer, Connection{now}).first->second;
    connection.seen = true;
    if (is_over(fd, connection, now, crowded)) ::shutdown(fd, SHUT_RDWR);
  });
  std::erase_if(connections_, [](const auto& entry) { return !entry.second.seen; });
}

void cut_off_clients(int port) {
  for_each_client(port, [](int fd, const auto&) { ::shutdown(fd, SHUT_RDWR); });
}

}  // namespace ydd
