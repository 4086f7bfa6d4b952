// SPDX-License-Identifier: Apache-2.0
//
// `run --serve` as people meet it: the program, its page in a browser, and what is left in the
// end.
#include <chrono>
#include <future>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "browser.h"
#include "small_world.h"

namespace ydd::e2e {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// `ydd-slam run --serve` of a simulated room at the camera's pace, paused as soon as it answers.
class ServedRun {
 public:
  explicit ServedRun(const fs::path& out, std::vector<std::string> options = {}) {
    std::vector<std::string> arguments = {YDD_BINARY, "run",        room().string(),
                                          "--out",    out.string(), "--realtime",
                                          "--serve",  "127.0.0.1:0"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    run_ = std::async(std::launch::async, [this, arguments] {
      std::vector<std::string> shell = {"/bin/sh", "-c", "exec \"$@\" 2>\"$0\"", log().string()};
      shell.insert(shell.end(), arguments.begin(), arguments.end());
      return run_program(shell);
    });
    while (url_.empty() && !ended()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      const std::string said = this->said();
      const auto begin = said.find("http://");
      const auto end = said.find('\n', begin);
      if (begin != std::string::npos && end != std::string::npos)
        url_ = said.substr(begin, end - begin);
    }
    command("pause");
  }
  ~ServedRun() {
    if (!ended()) command("quit");
  }

  const std::string& url() const { return url_; }
  std::string said() const {
    const auto text = read_file(log());
    return text ? *text : std::string();
  }
  bool ended() const {
    return !run_.valid() || run_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }
  Outcome wait() { return run_.get(); }

  httplib::Client client() const {
    // http://127.0.0.1:PORT/...
    httplib::Client out(url_.substr(0, url_.find('/', 7)));
    out.set_default_headers({{"X-Ydd-Slam", "1"}});
    return out;
  }
  void command(const std::string& text) const { client().Post("/command", text, "text/plain"); }
  /// The state once `is_so(state)`; null if the run ends first.
  template <class Predicate>
  json state_when(Predicate is_so) const {
    while (!ended()) {
      const auto answer = client().Get("/state.json");
      json state = answer && answer->status == 200 ? json::parse(answer->body) : json();
      if (!state.is_null() && is_so(state)) return state;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return {};
  }

 private:
  fs::path log() const { return scratch_ / "log"; }

  TemporaryFolder scratch_;
  std::string url_;
  mutable std::future<Outcome> run_;
};

TEST(LivePage, TakesCommandsAndTheRunLeavesItsResults) {
  // A dozen frames at the camera's pace: sanitized, they are over or dropped before a command
  // comes.
  if (kSanitized) GTEST_SKIP() << "too few frames to step through";
  const TemporaryFolder folder;
  ServedRun run(folder / "a");
  ASSERT_FALSE(run.url().empty()) << run.said();
  for (int i = 0; i < 3; ++i) run.command("step");
  const json paused =
      run.state_when([](const json& s) { return s.at("paused") && s.at("frame") >= 2; });
  ASSERT_FALSE(paused.is_null()) << run.said();
  run.command("step");
  const json stepped =
      run.state_when([&](const json& s) { return s.at("frame") > paused.at("frame"); });
  EXPECT_EQ(stepped.at("paused"), true);
  EXPECT_EQ(stepped.at("state"), "tracking");
  run.command("quit");
  EXPECT_EQ(run.wait().exit_code, 0) << run.said();
  const json summary = json::parse(read_file(folder / "a/summary.json").value());
  EXPECT_EQ(summary.at("live_commands").back().at("command"), "quit");
  EXPECT_TRUE(fs::exists(folder / "a/report.html"));
}

TEST(LivePage, InABrowser) {
  YDD_NEEDS_CHROMIUM();
  const TemporaryFolder folder;
  ServedRun run(folder / "a", {"--serve-token", "open-sesame"});
  ASSERT_FALSE(run.url().empty()) << run.said();
  httplib::Client client = run.client();
  client.set_default_headers({{"X-Ydd-Slam", "1"}, {"X-Ydd-Token", "open-sesame"}});
  client.Post("/command", "pause", "text/plain");
  for (int i = 0; i < 5; ++i) client.Post("/command", "step", "text/plain");
  for (int frame = -1; frame < 4 && !run.ended();) {
    const auto answer = client.Get("/state.json");
    if (answer && answer->status == 200) frame = json::parse(answer->body).at("frame");
  }
  const Outcome page = dump_dom(run.url());
  ASSERT_EQ(page.exit_code, 0) << page.err;
  EXPECT_THAT(page.err, Not(HasSubstr("Uncaught")));
  EXPECT_THAT(page.err, Not(HasSubstr("Refused to")));
  const auto begin = page.out.find("<body");
  const std::string body = page.out.substr(begin, page.out.find("<script", begin) - begin);
  EXPECT_THAT(body, HasSubstr("tracking, paused"));
  EXPECT_THAT(body, HasSubstr(fmt::format(" / {}</b><span>frame</span>", kFrames)));
  EXPECT_THAT(body, HasSubstr("src=\"blob:http://127.0.0.1"));
  EXPECT_THAT(body, HasSubstr("data-drawn=\""));
  EXPECT_THAT(body, Not(HasSubstr("data-drawn=\"0\"")));
  EXPECT_THAT(body, HasSubstr(">Resume</button>"));
  EXPECT_THAT(body, HasSubstr("dygraph-axis-label")) << "plots";
  EXPECT_THAT(body, Not(HasSubstr("NaN")));
  client.Post("/command", "quit", "text/plain");
  EXPECT_EQ(run.wait().exit_code, 0) << run.said();
}

}  // namespace
}  // namespace ydd::e2e
