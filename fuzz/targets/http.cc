// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "support.h"
#include "targets.h"
#include "ydd/live/live_server.h"

namespace ydd::fuzz {
namespace {

/// A page that is served while the process lives; no frame has come yet.
class Served {
 public:
  Served() : server_(LiveServer::start(control_, {"127.0.0.1", 0, ""}).value()) {}
  int port() const { return server_->port(); }

 private:
  LiveControl control_{LiveScene{}};
  std::unique_ptr<LiveServer> server_;
};

std::string answer_to(std::string_view request, int port) {
  const int connection = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (connection < 0) broken("no socket");
  // From another address each time: one alone runs out of ports after a few hundred thousand.
  static std::uint32_t count = 0;
  sockaddr_in from{};
  from.sin_family = AF_INET;
  from.sin_addr.s_addr = htonl(INADDR_LOOPBACK + 256U + ++count % 250U);
  if (::bind(connection, reinterpret_cast<const sockaddr*>(&from), sizeof(from)) != 0) {
    broken("no address of its own");
  }
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(connection, reinterpret_cast<const sockaddr*>(&to), sizeof(to)) != 0) {
    broken("the server takes no connection");
  }
  (void)::send(connection, request.data(), request.size(), MSG_NOSIGNAL);
  ::shutdown(connection, SHUT_WR);
  std::string answer;
  char part[4096];
  for (ssize_t n; (n = ::recv(connection, part, sizeof(part), 0)) > 0;) {
    answer.append(part, static_cast<std::size_t>(n));
  }
  ::close(connection);
  return answer;
}

}  // namespace

// The bytes of one connection. An answer, if there is one, is HTTP and no larger than the page.
void http(std::string_view input) {
  static const Served served;
  const std::string answer = answer_to(input, served.port());
  constexpr std::size_t kLargestAnswer = 4U << 20U;
  if (answer.size() > kLargestAnswer) broken("an answer larger than what there is");
  if (!answer.empty() && !answer.starts_with("HTTP/1.")) broken("an answer that is not HTTP");
}

}  // namespace ydd::fuzz
