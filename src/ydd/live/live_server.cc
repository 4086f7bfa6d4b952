// SPDX-License-Identifier: Apache-2.0
//
// The one file of this room with threads: those of the server.
#include "ydd/live/live_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <atomic>
#include <cctype>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <regex>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <httplib.h>

#include "ydd/base/channel.h"
#include "ydd/base/one_line.h"
#include "ydd/image/jpeg_codec.h"
#include "ydd/live/connection_guard.h"
#include "ydd/live/live_json.h"
#include "ydd/live/live_page.h"
#include "ydd/pictures/annotate.h"

namespace ydd {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kWorkers = 16;
constexpr std::size_t kWaiting = 64;  // then accepting waits, and the kernel's short queue fills
constexpr int kTimeout_s = 2;         // of silence
constexpr std::chrono::milliseconds kSweep{50};
constexpr std::size_t kLongestBody = 256;
constexpr std::size_t kLongestSkipped = 65536;  // a longer body is not even read
constexpr int kJpegQuality = 80;
constexpr const char* kTokenLetters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
constexpr std::chrono::seconds kFarewell{2};  // for pages that have asked within this time
constexpr const char* kState = "/state.json";
constexpr const char* kFinished = "X-Ydd-Finished";  // header of answers after the last frame
constexpr int kBadRequest = 400, kForbidden = 403, kWrongMethod = 405, kNoLength = 411,
              kTooLong = 413, kWrongRange = 416, kUnavailable = 503;

/// How many requests wait for a worker, and how many there are with those being answered.
struct Load {
  std::atomic<int> waiting = 0, all = 0;
};

/// Requests to a few threads. A full queue holds up accepting, so that connections stay few.
class BoundedQueue final : public httplib::TaskQueue {
 public:
  explicit BoundedQueue(Load& load) : load_(load) {
    for (std::size_t i = 0; i < kWorkers; ++i) {
      workers_.emplace_back([this] {
        while (const auto task = tasks_.pop()) {
          --load_.waiting;
          (*task)();
          --load_.all;
        }
      });
    }
  }
  /// Newer versions of the library want to know whether the task was taken, older ones nothing.
  using Taken = decltype(std::declval<httplib::TaskQueue&>().enqueue(nullptr));
  Taken enqueue(std::function<void()> task) override {
    ++load_.all;
    ++load_.waiting;
    return static_cast<Taken>(tasks_.push(std::move(task)));
  }
  void shutdown() override {
    tasks_.close();
    workers_.clear();  // joins
  }

 private:
  Load& load_;
  Channel<std::function<void()>> tasks_{kWaiting};
  std::vector<std::jthread> workers_;
};

bool is_loopback(const std::string& address) {
  in_addr ipv4{};
  if (::inet_pton(AF_INET, address.c_str(), &ipv4) == 1) return ntohl(ipv4.s_addr) >> 24U == 127;
  return address == "localhost" || address == "::1";
}

/// The host of "host", "host:port" or "[ipv6]:port", in small letters; none of anything else.
std::optional<std::string> host_of(const std::string& header) {
  static const std::regex form(R"((?:([A-Za-z0-9._-]+)|\[([0-9A-Fa-f:.]+)\])(?::(\d{1,5}))?)");
  std::smatch match;
  if (header.size() > 255 || !std::regex_match(header, match, form)) return std::nullopt;
  if (match[3].matched && std::stoi(match[3]) > 65535) return std::nullopt;
  std::string host = match[1].matched ? match[1] : match[2];
  for (char& c : host) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return host;
}

/// Digits alone, and not too many.
std::optional<std::size_t> length_of(const std::string& header) {
  std::size_t length = 0;
  const char* const end = header.data() + header.size();
  const auto [stop, error] = std::from_chars(header.data(), end, length);
  if (error != std::errc() || stop != end) return std::nullopt;
  return length;
}

ConnectionGuard::Peer peer_of(const httplib::Request& request) {
  return {request.remote_addr, request.remote_port};
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
    server_.new_task_queue = [this] { return new BoundedQueue(load_); };  // httplib deletes it
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
      if (const int status = malformed(request); status != 0) {
        response.status = status;  // and no text, of which somebody could ask for many ranges
        return httplib::Server::HandlerResponse::Handled;
      }
      if (allowed(request)) {
        if (request.path == kState) last_asked_ = Clock::now();  // and again when it is answered
        if (request.method != "POST") know(request);             // else its body is still to come
        return httplib::Server::HandlerResponse::Unhandled;
      }
      response.status = kForbidden;
      response.set_content("not allowed: open the address that ydd-slam printed, with its token\n",
                           "text/plain");
      return httplib::Server::HandlerResponse::Handled;
    });
    // httplib logs an answer when it has been written.
    server_.set_logger([this](const httplib::Request& request, const httplib::Response& response) {
      {
        const std::lock_guard lock(guard_mutex_);
        guard_.answered(peer_of(request));
      }
      if (request.path != kState) return;
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
    sweeper_ = std::jthread([this](const std::stop_token& stop) { sweep(stop); });
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
    sweeper_ = {};
    server_.stop();
    cut_off_clients(options_.port);
    if (thread_.joinable()) thread_.join();
  }

  const LiveServerOptions& options() const { return options_; }

 private:
  /// The status that refuses a request of a form no page of ours sends; 0: none.
  static int malformed(const httplib::Request& request) {
    if (request.get_header_value_count("Host") != 1) return kBadRequest;
    if (!host_of(request.get_header_value("Host"))) return kBadRequest;
    if (request.method != "GET" && request.method != "HEAD" && request.method != "POST") {
      return kWrongMethod;
    }
    if (request.ranges.size() > 1) return kWrongRange;  // each would be copied
    // Without a length there is no limit to what the library reads.
    if (request.has_header("Transfer-Encoding")) return kNoLength;
    if (request.method != "POST") return 0;
    if (request.get_header_value_count("Content-Length") != 1) return kNoLength;
    const auto length = length_of(request.get_header_value("Content-Length"));
    return !length ? kBadRequest : *length > kLongestSkipped ? kTooLong : 0;
  }

  void know(const httplib::Request& request) {
    const std::lock_guard lock(guard_mutex_);
    guard_.asked(peer_of(request));
  }

  void sweep(const std::stop_token& stop) {
    std::unique_lock lock(guard_mutex_);
    while (!stop.stop_requested()) {
      sweeping_.wait_for(lock, stop, kSweep, [] { return false; });
      if (load_.all > 0) guard_.sweep(options_.port, Clock::now(), load_.waiting > 0);
    }
  }

  bool allowed(const httplib::Request& request) const {
    if (!options_.token.empty()) {
      const std::string given = request.has_header("X-Ydd-Token")
                                    ? request.get_header_value("X-Ydd-Token")
                                    : request.get_param_value("token");
      return same_token(given, options_.token);
    }
    // A name that somebody else's DNS leads here is not one of these. The port may be another:
    // that of a tunnel.
    const std::optional<std::string> host = host_of(request.get_header_value("Host"));
    if (host != "127.0.0.1" && host != "localhost" && host != "::1" && host != options_.address) {
      return false;
    }
    return request.method != "POST" || request.has_header("X-Ydd-Slam");
  }

  void add_routes() {
    server_.Get("/", [](const httplib::Request&, httplib::Response& response) {
      response.set_content(live_page(), "text/html; charset=utf-8");
    });
    get(kState, "application/json", state_,
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
    know(request);
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
  Load load_;
  std::mutex guard_mutex_;
  std::condition_variable_any sweeping_;  // interrupts the wait between two sweeps
  ConnectionGuard guard_;
  httplib::Server server_;
  std::jthread thread_, sweeper_;
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
    return Error{fmt::format("--serve {}: must be PORT, ADDR or ADDR:PORT", on_one_line(text))};
  }
  if (match[1].matched) out.address = match[1];
  if (match[3].matched) out.address = match[3];
  if (out.address.front() == '[') out.address = out.address.substr(1, out.address.size() - 2);
  if (!is_loopback(out.address) && token.empty()) {
    return Error{
        fmt::format("--serve {}: others can reach this address; say what they must know "
                    "with --serve-token",
                    on_one_line(text))};
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
