// SPDX-License-Identifier: Apache-2.0
//
// The one file of this room with threads: those of the server.
#include "ydd/viewer/live_server.h"

#include <dirent.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <mutex>
#include <regex>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <httplib.h>

#include "ydd/base/channel.h"
#include "ydd/image/jpeg_codec.h"
#include "ydd/viewer/annotate.h"
#include "ydd/viewer/live_json.h"
#include "ydd/viewer/live_page.h"

namespace ydd {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kWorkers = 4;
constexpr std::size_t kWaiting = 16;  // then accepting waits, and the kernel's short queue fills
constexpr int kTimeout_s = 5;
constexpr std::size_t kLongestBody = 256;
constexpr int kJpegQuality = 80;
constexpr const char* kTokenLetters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
constexpr std::chrono::seconds kFarewell{1};         // for pages that have asked within this time
constexpr const char* kFinished = "X-Ydd-Finished";  // header of answers after the last frame
constexpr int kForbidden = 403, kUnavailable = 503, kBadRequest = 400;

/// Requests to a few threads. A full queue holds up accepting, so that connections stay few.
class BoundedQueue final : public httplib::TaskQueue {
 public:
  BoundedQueue() {
    for (std::size_t i = 0; i < kWorkers; ++i) {
      workers_.emplace_back([this] {
        while (const auto task = tasks_.pop()) (*task)();
      });
    }
  }
  void enqueue(std::function<void()> task) override { tasks_.push(std::move(task)); }
  void shutdown() override {
    tasks_.close();
    workers_.clear();  // joins
  }

 private:
  Channel<std::function<void()>> tasks_{kWaiting};
  std::vector<std::jthread> workers_;
};

bool is_loopback(const std::string& address) {
  return address == "localhost" || address == "::1" || address.starts_with("127.");
}

/// The host of "host", "host:port" or "[ipv6]:port".
std::string host_of(const std::string& header) {
  if (header.starts_with('[')) return header.substr(1, header.find(']') - 1);
  return header.substr(0, header.find(':'));
}

/// Takes as long for a nearly right token as for a wrong one.
bool same_token(std::string_view given, std::string_view wanted) {
  unsigned difference = given.size() == wanted.size() ? 0U : 1U;
  for (std::size_t i = 0; i < given.size(); ++i) {
    difference |= static_cast<unsigned char>(given[i]) ^
                  static_cast<unsigned char>(wanted[i % wanted.size()]);
  }
  return difference == 0;
}

/// Ends the connections to `port` that are still open: their readers wake up.
void cut_off_clients(int port) {
  DIR* const folder = ::opendir("/proc/self/fd");
  if (!folder) return;
  while (const dirent* const entry = ::readdir(folder)) {
    int fd = -1;
    const char* const end = entry->d_name + std::char_traits<char>::length(entry->d_name);
    if (std::from_chars(entry->d_name, end, fd).ptr != end) continue;
    sockaddr_storage local{}, peer{};
    socklen_t local_size = sizeof(local), peer_size = sizeof(peer);
    if (::getsockname(fd, reinterpret_cast<sockaddr*>(&local), &local_size) != 0) continue;
    if (::getpeername(fd, reinterpret_cast<sockaddr*>(&peer), &peer_size) != 0) continue;
    // Both families keep the port in the same place.
    const int local_port = ntohs(reinterpret_cast<const sockaddr_in*>(&local)->sin_port);
    const bool internet = local.ss_family == AF_INET || local.ss_family == AF_INET6;
    if (internet && local_port == port) ::shutdown(fd, SHUT_RDWR);
  }
  ::closedir(folder);
}

/// What was made of a published frame, once for all who ask.
class Cache {
 public:
  template <class Make>
  std::shared_ptr<const std::string> get(std::int64_t serial, Make make) {
    const std::lock_guard lock(mutex_);
    if (!text_ || serial_ != serial) {
      text_ = std::make_shared<const std::string>(make());
      serial_ = serial;
    }
    return text_;
  }

 private:
  std::mutex mutex_;
  std::int64_t serial_ = 0;
  std::shared_ptr<const std::string> text_;
};

}  // namespace

class LiveServer::State {
 public:
  State(LiveControl& control, const LiveServerOptions& options)
      : control_(control), options_(options) {
    server_.new_task_queue = [] { return new BoundedQueue; };  // httplib deletes it
    server_.set_keep_alive_max_count(1);  // an idle connection would keep a worker
    server_.set_read_timeout(kTimeout_s);
    server_.set_write_timeout(kTimeout_s);
    server_.set_payload_max_length(kLongestBody);
    server_.set_tcp_nodelay(true);
    // Not shared with another server, which httplib would allow: a taken port is a failure.
    server_.set_socket_options([](int socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
    server_.set_default_headers({{"Cache-Control", "no-store"},
                                 {"X-Content-Type-Options", "nosniff"},
                                 {"X-Frame-Options", "DENY"},
                                 {"Referrer-Policy", "no-referrer"}});
    server_.set_pre_routing_handler([this](const httplib::Request& request,
                                           httplib::Response& response) {
      if (allowed(request)) return httplib::Server::HandlerResponse::Unhandled;
      response.status = kForbidden;
      response.set_content("not allowed: open the address that ydd-slam printed, with its token\n",
                           "text/plain");
      return httplib::Server::HandlerResponse::Handled;
    });
    // httplib logs an answer when it has been written.
    server_.set_logger([this](const httplib::Request& request, const httplib::Response& response) {
      if (request.path != "/state.json") return;
      last_asked_ = Clock::now();
      if (response.has_header(kFinished)) end_told_ = true;
    });
    add_routes();
  }

  bool bind() {
    if (options_.port != 0) return server_.bind_to_port(options_.address, options_.port);
    options_.port = server_.bind_to_any_port(options_.address);
    return options_.port > 0;
  }

  void listen() {
    thread_ = std::jthread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::yield();  // stopping earlier has no effect
  }

  /// A page that has just asked hears that the run has ended, before the connection is gone.
  void tell_end() const {
    const Clock::time_point now = Clock::now(), end = now + kFarewell;
    if (now - last_asked_.load() > kFarewell) return;
    const auto live = control_.newest();
    if (!live || !live->status.finished) return;
    while (!end_told_ && Clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  void stop() {
    tell_end();
    server_.stop();
    cut_off_clients(options_.port);
    if (thread_.joinable()) thread_.join();
  }

  const LiveServerOptions& options() const { return options_; }

 private:
  bool allowed(const httplib::Request& request) const {
    if (!options_.token.empty()) {
      const std::string given = request.has_header("X-Ydd-Token")
                                    ? request.get_header_value("X-Ydd-Token")
                                    : request.get_param_value("token");
      return same_token(given, options_.token);
    }
    if (!is_loopback(host_of(request.get_header_value("Host")))) return false;
    return request.method != "POST" || request.has_header("X-Ydd-Slam");
  }

  void add_routes() {
    server_.Get("/", [](const httplib::Request&, httplib::Response& response) {
      response.set_content(live_page(), "text/html; charset=utf-8");
    });
    get("/state.json", "application/json", state_,
        [this](const LiveFrame& live) { return live_state_json(control_.scene(), live); });
    get("/map.json", "application/json", map_,
        [this](const LiveFrame& live) { return live_map_json(control_.scene(), live); });
    get("/frame.jpg", "image/jpeg", picture_, [this](const LiveFrame& live) {
      auto jpeg = encode_jpeg(annotate(live.frame, *live.report, control_.scene().catalogue,
                                       {live.status.frames_per_second, {}}),
                              kJpegQuality);
      return jpeg ? *std::move(jpeg) : std::string();
    });
    get("/trajectory.tum", "text/plain", trajectory_,
        [](const LiveFrame& live) { return live_trajectory_tum(live); });
    get("/map.ply", "application/octet-stream", ply_,
        [](const LiveFrame& live) { return live_map_ply(live); });
    server_.Post("/command", [this](const httplib::Request& request, httplib::Response& response) {
      take_command(request, response);
    });
  }

  /// `make(newest frame)` as the answer; what was made last serves until a newer frame is there.
  template <class Make>
  void get(const char* path, const char* type, Cache& cache, Make make) {
    server_.Get(path,
                [this, type, &cache, make](const httplib::Request&, httplib::Response& response) {
                  const auto live = control_.newest();
                  if (!live) {
                    response.status = kUnavailable;
                    response.set_content("no frame yet\n", "text/plain");
                    return;
                  }
                  if (live->status.finished) response.set_header(kFinished, "1");
                  response.set_content(*cache.get(live->serial, [&] { return make(*live); }), type);
                });
  }

  void take_command(const httplib::Request& request, httplib::Response& response) {
    const Result<LiveCommand> command = parse_live_command(request.body);
    if (!command) {
      response.status = kBadRequest;
      response.set_content(command.error().message + "\n", "text/plain");
    } else if (!control_.send(*command)) {
      response.status = kUnavailable;
      response.set_content("the run has ended\n", "text/plain");
    } else {
      response.set_content("done between two frames\n", "text/plain");
    }
  }

  LiveControl& control_;
  LiveServerOptions options_;
  Cache state_, map_, picture_, trajectory_, ply_;
  std::atomic<Clock::time_point> last_asked_{Clock::time_point{}};
  std::atomic<bool> end_told_ = false;
  httplib::Server server_;
  std::jthread thread_;
};

Result<LiveServerOptions> parse_live_address(std::string_view text, const std::string& token) {
  // Address (a name, IPv4, or IPv6 in brackets), then a port; either may be missing.
  static const std::regex form(
      R"((?:([A-Za-z][\w.-]*|[\d.]+\.[\d.]+|\[[\da-fA-F:.]+\])?:)?(\d{1,5})|)"
      R"(([A-Za-z][\w.-]*|[\d.]+\.[\d.]+|\[[\da-fA-F:.]+\])|)");
  std::cmatch match;
  const bool known = std::regex_match(text.data(), text.data() + text.size(), match, form);
  if (token.find_first_not_of(kTokenLetters) != std::string::npos) {
    return Error{"--serve-token: letters, digits and -._~ only: it is part of an address"};
  }
  LiveServerOptions out;
  out.token = token;
  if (known && match[2].matched) out.port = std::stoi(match[2]);
  if (!known || out.port > 65535) {
    return Error{fmt::format("--serve {}: must be PORT, ADDR or ADDR:PORT", text)};
  }
  if (match[1].matched) out.address = match[1];
  if (match[3].matched) out.address = match[3];
  if (out.address.front() == '[') out.address = out.address.substr(1, out.address.size() - 2);
  if (!is_loopback(out.address) && token.empty()) {
    return Error{
        fmt::format("--serve {}: others can reach this address; say what they must know "
                    "with --serve-token",
                    text)};
  }
  return out;
}

LiveServer::LiveServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

LiveServer::~LiveServer() { state_->stop(); }

Result<std::unique_ptr<LiveServer>> LiveServer::start(LiveControl& control,
                                                      const LiveServerOptions& options) {
  auto state = std::make_unique<State>(control, options);
  if (!state->bind()) {
    return Error{
        fmt::format("--serve: cannot listen on {} port {} (is it in use?); name another "
                    "with --serve ADDR:PORT",
                    options.address, options.port)};
  }
  state->listen();
  return std::unique_ptr<LiveServer>(new LiveServer(std::move(state)));
}

int LiveServer::port() const { return state_->options().port; }

std::string LiveServer::url() const {
  const LiveServerOptions& o = state_->options();
  const bool ipv6 = o.address.find(':') != std::string::npos;
  return fmt::format("http://{}{}{}:{}/{}{}", ipv6 ? "[" : "", o.address, ipv6 ? "]" : "", o.port,
                     o.token.empty() ? "" : "?token=", o.token);
}

}  // namespace ydd
