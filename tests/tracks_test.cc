// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command_line.h"
#include "small_world.h"
#include "ydd/base/timing.h"
#include "ydd/studies/track_errors.h"

/// People in the map's frame, from pictures to files.
namespace ydd::e2e {
namespace {

using nlohmann::json;

TEST(Tracks, PeopleOfASimulatedRoomAreWhereTheyAre) {
  if (kSanitized) GTEST_SKIP() << "too slow in a sanitized program";
  WorldOptions world;
  world.seed = 101;
  world.width_px = 320;
  world.height_px = 240;
  world.fps = 15;
  world.frames = 75;
  world.busy = true;
  world.depth = DepthModel::kinect;
  world.threads = 0;
  world.edge_samples = 1;
  const Simulator simulator(world);
  SystemOptions options;
  options.deterministic = true;
  const auto run = run_simulated(simulator, options);
  ASSERT_TRUE(run) << run.error().message;
  const TrackErrors errors = track_errors(*run, simulator);
  ASSERT_GT(errors.wanted, 100);
  EXPECT_GT(errors.found, 0.9 * errors.wanted);
  EXPECT_LT(errors.false_ones, 0.1 * errors.told);
  EXPECT_LE(errors.switches, 1);
  EXPECT_LT(statistics_of(errors.across_m).median, 0.1);
  EXPECT_LT(statistics_of(errors.across_m).p95, 0.3);
  EXPECT_LT(statistics_of(errors.velocity_m_s).median, 0.3);
}

TEST(Tracks, ARunLeavesALinePerFrameAndTheReportShowsThem) {
  const TemporaryFolder scratch;
  const fs::path sequence = busy_room(), out = fs::path(scratch / "run");
  const Outcome run =
      ydd_slam({"run", sequence.string(), "--out", out.string(), "--quiet", "--deterministic",
                "--detections", (sequence / "detections.jsonl").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::ifstream file(out / "tracks.jsonl");
  std::string line;
  int frames = 0;
  std::set<std::int64_t> people;
  while (std::getline(file, line)) {
    const json frame = json::parse(line);
    EXPECT_EQ(frame.at("frame"), frames);
    ++frames;
    for (const json& track : frame.at("tracks")) {
      if (track.at("class") != "person") continue;
      people.insert(track.at("id").get<std::int64_t>());
      EXPECT_GT(track.at("position_m").at(2).get<double>(), 0.2) << "before the camera";
      EXPECT_LT(track.at("position_m").at(2).get<double>(), 8.0);
    }
  }
  EXPECT_EQ(frames, kFrames);
  EXPECT_GE(people.size(), 1U);
  EXPECT_LE(people.size(), 6U);
  std::ifstream report(out / "report.html");
  const std::string html((std::istreambuf_iterator<char>(report)), {});
  EXPECT_NE(html.find("\"class\":\"person\""), std::string::npos);
}

/// By id, where each person that a run tells of was first told, in frames.
std::map<std::int64_t, int> first_told(const fs::path& tracks) {
  std::map<std::int64_t, int> first;
  std::ifstream file(tracks);
  for (std::string line; std::getline(file, line);) {
    const json frame = json::parse(line);
    for (const json& track : frame.at("tracks")) {
      if (track.at("class") != "person") continue;
      first.emplace(track.at("id").get<std::int64_t>(), frame.at("frame").get<int>());
    }
  }
  return first;
}

TEST(Tracks, AMarkOnTheWallThatLooksLikeAPersonIsToldToNobody) {
  const char* const data = std::getenv("YDD_DATA");  // NOLINT(concurrency-mt-unsafe)
  const fs::path clip = fs::path(data == nullptr ? "" : data) / "bonn_crowd_clip";
  if (kSanitized || data == nullptr || !fs::exists(clip)) {
    GTEST_SKIP() << "needs YDD_DATA/bonn_crowd_clip";
  }
  const TemporaryFolder scratch;
  const fs::path out = fs::path(scratch / "run");
  const Outcome run =
      ydd_slam({"run", clip.string(), "--out", out.string(), "--quiet", "--deterministic",
                "--detector", YDD_SOURCE_DIR "/configs/detector/ydd.yaml"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  constexpr int kFirstMan = 15;  // before it the laboratory is empty but for the mark
  const auto told = first_told(out / "tracks.jsonl");
  EXPECT_GE(told.size(), 3U) << "three men walk past";
  for (const auto& [id, frame] : told) EXPECT_GE(frame, kFirstMan) << "track " << id;
}

}  // namespace
}  // namespace ydd::e2e
