// SPDX-License-Identifier: Apache-2.0
#include "ydd/live/live_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "ydd/live/live_json.h"
#include "ydd/live/live_run.h"
#include "ydd/system/picture_testing.h"

namespace ydd {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;
using testing_world::Wall;

const httplib::Headers kOurs = {{"X-Ydd-Slam", "1"}};

/// A run along a patterned wall, and a page that shows it.
class LiveServerTest : public testing::Test {
 protected:
  LiveServerTest()
      : wall_(12),
        control_(scene(wall_)),
        system_(wall_.camera(), deterministic(), ObjectCatalogue::defaults(), nullptr),
        run_(control_, system_) {}

  static LiveScene scene(const Wall& wall) {
    LiveScene out;
    out.sequence = "wall";
    out.frames = 12;
    out.camera = wall.camera();
    out.catalogue = ObjectCatalogue::defaults();
    for (int i = 0; i < 12; ++i) out.groundtruth.push_back({wall.stamp(i), wall.T_world_camera(i)});
    return out;
  }
  static SystemOptions deterministic() {
    SystemOptions options;
    options.deterministic = true;
    return options;
  }
  /// Frames `first` to `last`.
  void process(int first, int last) {
    for (int i = first; i <= last; ++i) {
      const RgbdFrame frame = wall_.frame(i);
      run_.publish(frame, system_.process(frame).value());
    }
  }
  void serve(const std::string& token = "") {
    LiveServerOptions options;
    options.port = 0;
    options.token = token;
    auto server = LiveServer::start(control_, options);
    ASSERT_TRUE(server) << server.error().message;
    server_ = *std::move(server);
  }
  httplib::Client client() const {
    httplib::Client out("127.0.0.1", server_->port());
    out.set_default_headers(kOurs);
    return out;
  }
  std::string body(const std::string& path) const {
    const auto answer = client().Get(path);
    return answer && answer->status == 200 ? answer->body : "no answer";
  }
  json json_of(const std::string& path) const { return json::parse(body(path), nullptr, false); }

  Wall wall_;
  LiveControl control_;
  SlamSystem system_;
  LiveRun run_;
  std::unique_ptr<LiveServer> server_;
};

TEST_F(LiveServerTest, BeforeTheFirstFrameThereIsThePageAlone) {
  serve();
  EXPECT_THAT(body("/"), HasSubstr("state.json"));
  EXPECT_THAT(body("/"), testing::Not(HasSubstr("@PAGE_JS@")));
  EXPECT_EQ(client().Get("/state.json")->status, 503);
  EXPECT_EQ(client().Get("/nothing")->status, 404);
}

TEST_F(LiveServerTest, ShowsTheNewestFrame) {
  serve();
  process(0, 5);
  const json state = json_of("/state.json");
  EXPECT_EQ(state.at("sequence"), "wall");
  EXPECT_EQ(state.at("frame"), 5);
  EXPECT_EQ(state.at("state"), "tracking");
  EXPECT_EQ(state.at("recent").at("frame").size(), 6U);
  EXPECT_GT(state.at("keyframes"), 0);
  EXPECT_GT(state.at("kept"), 100);
  EXPECT_TRUE(state.at("stages_ms").contains("total"));
  EXPECT_THAT(body("/frame.jpg"), StartsWith("\xff\xd8"));
  process(6, 6);
  EXPECT_EQ(json_of("/state.json").at("frame"), 6);
}

TEST_F(LiveServerTest, ShowsTheMapFromAbove) {
  serve();
  process(0, 11);
  const json map = json_of("/map.json");
  EXPECT_GT(map.at("points").size(), 200U);
  ASSERT_EQ(map.at("path").size(), 24U);
  EXPECT_NEAR(map.at("path").at(22), wall_.T_world_camera(11).translation().x(), 0.005);
  EXPECT_NEAR(map.at("camera").at(2), 1.571, 0.02) << "it looks ahead";
  EXPECT_EQ(map.at("lost"), false);
  const std::string trajectory = body("/trajectory.tum");
  EXPECT_EQ(std::count(trajectory.begin(), trajectory.end(), '\n'), 12);
  EXPECT_THAT(body("/map.ply"), StartsWith("ply\nformat binary_little_endian 1.0\n"));
}

TEST_F(LiveServerTest, ShowsPeopleFromAbove) {
  process(0, 3);
  LiveFrame live = *control_.newest();
  WorldTrack track;
  track.id = 5;
  track.class_name = "person";
  track.position_m = {1, 9, 3};
  track.velocity_m_s = {0.5, 0, -0.25};
  FrameReport report = *live.report;
  report.tracks = {track};
  live.report = std::make_shared<const FrameReport>(report);
  const json map = json::parse(live_map_json(control_.scene(), live));
  EXPECT_EQ(map.at("tracks"), json::array({json::array({1.0, 3.0, 0.5, -0.25, 5, "person"})}));
}

TEST_F(LiveServerTest, CommandsReachTheRun) {
  serve();
  process(0, 2);
  EXPECT_EQ(client().Post("/command", "pause", "text/plain")->status, 200);
  EXPECT_EQ(client().Post("/command", "step", "text/plain")->status, 200);
  EXPECT_TRUE(run_.ready_for_frame());
  EXPECT_EQ(json_of("/state.json").at("paused"), true);
  const auto wrong = client().Post("/command", "dance", "text/plain");
  EXPECT_EQ(wrong->status, 400);
  EXPECT_THAT(wrong->body, HasSubstr("dance"));
  EXPECT_EQ(client().Post("/command", std::string(1000, 'x'), "text/plain")->status, 413);
  run_.finish();
  EXPECT_EQ(client().Post("/command", "pause", "text/plain")->status, 503);
  EXPECT_EQ(json_of("/state.json").at("finished"), true);
}

TEST_F(LiveServerTest, APageThatIsOpenHearsOfTheEnd) {
  serve();
  process(0, 1);
  ASSERT_EQ(json_of("/state.json").at("finished"), false);
  httplib::Client page = client();
  run_.finish();
  std::jthread leaving([this] { server_.reset(); });
  std::this_thread::sleep_for(std::chrono::milliseconds(150));  // as a page does between questions
  const auto answer = page.Get("/state.json");
  ASSERT_TRUE(answer);
  EXPECT_EQ(json::parse(answer->body).at("finished"), true);
}

TEST_F(LiveServerTest, OtherSitesInTheBrowserCanNeitherReadNorCommand) {
  serve();
  process(0, 0);
  httplib::Client other("127.0.0.1", server_->port());
  EXPECT_EQ(other.Post("/command", "pause", "text/plain")->status, 403);
  other.set_default_headers({{"Host", "evil.example"}});
  EXPECT_EQ(other.Get("/state.json")->status, 403);
}

TEST_F(LiveServerTest, WithATokenNothingIsToldWithoutIt) {
  serve("secret");
  process(0, 0);
  EXPECT_THAT(server_->url(), testing::EndsWith("/?token=secret"));
  for (const char* const path : {"/", "/state.json", "/frame.jpg", "/?token=", "/?token=secret1",
                                 "/state.json?token=Secret"}) {
    EXPECT_EQ(client().Get(path)->status, 403) << path;
  }
  EXPECT_EQ(client().Post("/command", "pause", "text/plain")->status, 403);
  EXPECT_EQ(client().Get("/?token=secret")->status, 200);
  EXPECT_EQ(client().Get("/state.json", {{"X-Ydd-Token", "secret"}})->status, 200);
}

/// A bare connection to the page.
int connected(int port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  ::inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
  EXPECT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  return fd;
}

/// A connection that asks for something and never finishes asking.
int hanging_client(int port) {
  const int fd = connected(port);
  EXPECT_GT(::send(fd, "GET /frame.jpg HT", 17, MSG_NOSIGNAL), 0);
  return fd;
}

/// The status of the answer to these very bytes; 0 without one.
int status_of(int port, const std::string& request) {
  const int fd = connected(port);
  EXPECT_GT(::send(fd, request.data(), request.size(), MSG_NOSIGNAL), 0);
  std::string answer;
  std::array<char, 512> part{};
  for (ssize_t n; (n = ::recv(fd, part.data(), part.size(), 0)) > 0;) answer.append(part.data(), n);
  ::close(fd);
  return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9)) : 0;
}

TEST_F(LiveServerTest, OnlyItsOwnNamesAreAnswered) {
  serve();
  const int port = server_->port();
  const auto asked = [&](const std::string& hosts) {
    return status_of(port, "GET / HTTP/1.1\r\n" + hosts + "\r\n");
  };
  for (const char* const own :
       {"127.0.0.1", "localhost", "LocalHost:8090", "[::1]:80", "127.0.0.1:65535"}) {
    EXPECT_EQ(asked("Host: " + std::string(own) + "\r\n"), 200) << own;
  }
  for (const char* const other : {"127.0.0.1.evil.com", "127.evil.com:8090", "localhost.evil.com",
                                  "localhost.", "evil.com", "127.0.0.2", "[::2]", "2130706433"}) {
    EXPECT_EQ(asked("Host: " + std::string(other) + "\r\n"), 403) << other;
  }
  for (const char* const broken :
       {"", "localhost:", "localhost:x", "localhost:65536", "localhost:80:80", "[::1", "::1",
        "a@localhost", "evil.com/localhost"}) {
    EXPECT_EQ(asked("Host: " + std::string(broken) + "\r\n"), 400) << broken;
  }
  EXPECT_EQ(asked(""), 400);
  EXPECT_EQ(asked("Host: localhost\r\nHost: evil.com\r\n"), 400);
}

TEST_F(LiveServerTest, BodiesWithoutEndAndManyRangesAreRefused) {
  serve();
  process(0, 0);
  const auto asked = [&](const std::string& line, const std::string& rest) {
    return status_of(server_->port(),
                     line + " HTTP/1.1\r\nHost: localhost\r\nX-Ydd-Slam: 1\r\n" + rest);
  };
  const std::string post = "POST /command", chunked = "Transfer-Encoding: chunked\r\n\r\n";
  EXPECT_EQ(asked(post, "Content-Length: 5\r\n\r\npause"), 200);
  EXPECT_EQ(asked(post, chunked), 411);
  EXPECT_EQ(asked(post, "\r\n"), 411);
  EXPECT_EQ(asked(post, "Content-Length: 5\r\nContent-Length: 6\r\n\r\n"), 411);
  EXPECT_EQ(asked(post, "Content-Length: -1\r\n\r\n"), 400);
  EXPECT_EQ(asked(post, "Content-Length: 99999999999999999999\r\n\r\n"), 400);
  EXPECT_EQ(asked(post, "Content-Length: 100000000\r\n\r\n"), 413);
  EXPECT_EQ(asked("PUT /command", chunked), 405);
  EXPECT_EQ(asked("GET /map.ply", "Range: bytes=0-1\r\n\r\n"), 206);
  EXPECT_EQ(asked("GET /map.ply", "Range: bytes=0-,0-,0-\r\n\r\n"), 416);
}

TEST_F(LiveServerTest, AHeaderWithoutEndIsCutOff) {
  serve();
  const int fd = connected(server_->port());
  const std::string part(4096, 'x');
  ASSERT_GT(::send(fd, "GET / HTTP/1.1\r\nX: ", 19, MSG_NOSIGNAL), 0);
  // It ends when the server has closed; sending alone would not tell while buffers are full.
  pollfd client{fd, POLLOUT | POLLRDHUP, 0};
  constexpr int kPatience_ms = 10'000;
  while (::poll(&client, 1, kPatience_ms) > 0 && (client.revents & ~POLLOUT) == 0) {
    ::send(fd, part.data(), part.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }
  EXPECT_NE(client.revents & ~POLLOUT, 0) << "still open";
  ::close(fd);
  EXPECT_THAT(body("/"), HasSubstr("state.json"));
}

/// Sends a letter again and again until the server has enough of it.
TEST_F(LiveServerTest, AClientThatDripsIsCutOff) {
  serve();
  const int fd = hanging_client(server_->port());
  while (::send(fd, "x", 1, MSG_NOSIGNAL) > 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  ::close(fd);
}

TEST_F(LiveServerTest, ACrowdOfHangingClientsShutsNobodyOut) {
  serve();
  std::atomic<bool> done = false;
  std::vector<int> clients;
  for (int i = 0; i < 60; ++i) clients.push_back(hanging_client(server_->port()));
  std::jthread drips([&] {  // so that the time of silence never ends
    while (!done) {
      for (const int fd : clients) ::send(fd, "x", 1, MSG_NOSIGNAL);
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });
  EXPECT_THAT(body("/"), HasSubstr("state.json"));
  done = true;
  drips.join();
  for (const int fd : clients) ::close(fd);
}

TEST_F(LiveServerTest, ClientsThatHangHoldUpNeitherRunNorEnd) {
  serve();
  std::vector<int> clients;
  for (int i = 0; i < 12; ++i) clients.push_back(hanging_client(server_->port()));
  process(0, 3);  // would never end if it waited for them
  EXPECT_EQ(control_.newest()->report->index, 3);
  server_.reset();  // likewise
  for (const int fd : clients) ::close(fd);
}

TEST_F(LiveServerTest, APortThatIsTakenIsNamed) {
  serve();
  LiveServerOptions options;
  options.port = server_->port();
  const auto second = LiveServer::start(control_, options);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr(std::to_string(options.port)));
}

TEST(LiveAddress, IsPortAddressOrBoth) {
  const auto parsed = [](const char* text, const char* token = "") {
    return parse_live_address(text, token).value();
  };
  EXPECT_EQ(parsed("").address, "127.0.0.1");
  EXPECT_EQ(parsed("").port, 8090);
  EXPECT_EQ(parsed("9000").port, 9000);
  EXPECT_EQ(parsed(":9000").address, "127.0.0.1");
  EXPECT_EQ(parsed("localhost:0").port, 0);
  EXPECT_EQ(parsed("[::1]:7").address, "::1");
  EXPECT_EQ(parsed("[::1]:7").port, 7);
  EXPECT_EQ(parsed("0.0.0.0", "t").address, "0.0.0.0");
}

TEST(LiveAddress, OthersMayReachItOnlyWithAToken) {
  for (const char* const open : {"0.0.0.0", "192.168.0.7:8090", "[::]:80", "robot.local"}) {
    const auto parsed = parse_live_address(open, "");
    ASSERT_FALSE(parsed) << open;
    EXPECT_THAT(parsed.error().message, HasSubstr("--serve-token"));
    EXPECT_TRUE(parse_live_address(open, "t")) << open;
  }
}

TEST(LiveAddress, ATokenMustFitIntoAnAddress) {
  EXPECT_TRUE(parse_live_address("", "open-Sesame_1.~"));
  for (const char* const wrong : {"open sesame", "a&b", "caf\xc3\xa9", "a\nb"}) {
    EXPECT_FALSE(parse_live_address("", wrong)) << wrong;
  }
}

TEST(LiveAddress, AnythingElseIsRefused) {
  for (const char* const wrong :
       {"127.0.0.1:http", "70000", "127.0.0.1:-1", "[::1", "a/b", "127.0.0.1:80:90"}) {
    EXPECT_FALSE(parse_live_address(wrong, "t")) << wrong;
  }
}

}  // namespace
}  // namespace ydd
