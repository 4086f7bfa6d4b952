// SPDX-License-Identifier: Apache-2.0
//
// Cameras as a user meets them: OpenNI2's own runtime, with a driver whose device plays a simulated
// room (tests/openni2/simulated_driver.cc). And recordings of runs.
#include <cmath>
#include <csignal>
#include <fstream>
#include <functional>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "small_world.h"
#include "ydd/bags/bag.h"
#include "ydd/bags/byte_source.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/image/decode.h"
#include "ydd/sources/source.h"

namespace ydd::e2e {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

std::string text_of(const fs::path& file) { return read_file(file).value(); }
json summary_of(const fs::path& run) { return json::parse(text_of(run / "summary.json")); }

TEST(Recording, OfAnyRecordingRunsAgainWithTheSameResult) {
  const TemporaryFolder folder;
  const std::vector<std::string> how = {"--deterministic", "--detector", "none", "--max-frames",
                                        "12"};
  std::vector<std::string> first = {"run",        room(),     "--out",
                                    folder / "a", "--record", folder / "b/walk.mcap"};
  first.insert(first.end(), how.begin(), how.end());
  const Outcome recorded = ydd_slam(first);
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  EXPECT_THAT(recorded.err,
              HasSubstr("12 frames recorded in " + (folder / "b/walk.mcap").string()));
  const Outcome again = ydd_slam({"run", folder / "b/walk.mcap", "--out", folder / "b/run",
                                  "--deterministic", "--detector", "none"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.err.find("warning"), std::string::npos) << again.err;
  EXPECT_EQ(text_of(folder / "a/trajectory.tum"), text_of(folder / "b/run/trajectory.tum"));
  EXPECT_EQ(summary_of(folder / "a").at("map_points"),
            summary_of(folder / "b/run").at("map_points"));
  // Nothing is left beside it.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "b"), fs::directory_iterator()), 2);
}

TEST(Recording, SensorsOfMotionComeAlong) {
  const TemporaryFolder folder;
  const fs::path walk = room();
  const std::vector<std::string> how = {"--deterministic",    "--detector", "none",
                                        "--max-frames",       "20",         "--config",
                                        walk / "sensors.yaml"};
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "run");
    arguments.insert(arguments.end(), how.begin(), how.end());
    Outcome outcome = ydd_slam(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome;
  };
  run({walk, "--imu", walk / "imu.csv", "--odometry", walk / "odometry.txt", "--out", folder / "a",
       "--record", folder / "walk.mcap"});
  // The configuration says how they are mounted: they are used by themselves.
  const Outcome again = run({folder / "walk.mcap", "--out", folder / "b"});
  EXPECT_THAT(again.err, HasSubstr("/imu predicts motion (--imu off: it does not)"));
  EXPECT_THAT(again.err, HasSubstr("/odom predicts motion"));
  EXPECT_EQ(text_of(folder / "a/trajectory.tum"), text_of(folder / "b/trajectory.tum"));
  EXPECT_EQ(text_of(folder / "a/tracks.jsonl"), text_of(folder / "b/tracks.jsonl"));
  const Outcome off =
      run({folder / "walk.mcap", "--imu", "off", "--odometry", "off", "--out", folder / "c"});
  EXPECT_EQ(off.err.find("predicts motion"), std::string::npos);
  const Outcome wrong = ydd_slam(
      {"run", folder / "walk.mcap", "--imu", "/gyro", "--out", folder / "d", "--detector", "none"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("--imu /gyro: no such file, nor a topic of"));
  EXPECT_THAT(wrong.err, HasSubstr("(there are: /imu)"));
}

TEST(Recording, KeepsWhatTheCameraIs) {
  const TemporaryFolder folder;
  std::ofstream(folder / "camera.yaml") << text_of(few_frames() / "camera.yaml") << "\n";
  ASSERT_EQ(ydd_slam({"run", few_frames(), "--camera", folder / "camera.yaml", "--set",
                      "camera.max_depth=3.5", "--set", "camera.k1=0.01", "--set", "camera.fps=17",
                      "--out", folder / "a", "--record", folder / "a.mcap", "--detector", "none"})
                .exit_code,
            0);
  const Camera camera = find_camera(open_recording(folder / "a.mcap").value()).value();
  EXPECT_EQ(camera.max_depth_m, 3.5);
  EXPECT_EQ(camera.k1, 0.01);
  EXPECT_EQ(camera.fps, 17);
  EXPECT_EQ(camera.depth_scale, 1000);
  // Who asks for CameraInfo gets what others read.
  const Camera info = find_camera(open_recording(folder / "a.mcap",
                                                 {.topic_camera_info = "/camera/color/camera_info"})
                                      .value())
                          .value();
  EXPECT_EQ(info.k1, 0.01);
  EXPECT_EQ(info.fx_px, camera.fx_px);
}

TEST(Recording, WhatCannotBeWrittenIsOneLine) {
  const TemporaryFolder folder;
  for (const char* const name : {"walk.bag", "walk"}) {
    const Outcome outcome = ydd_slam({"run", few_frames(), "--record", folder / name, "--out",
                                      folder / "out", "--detector", "none"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("must end in .mcap"));
  }
  std::ofstream(folder / "file") << "x";
  const Outcome outcome = ydd_slam({"run", few_frames(), "--record", folder / "file/walk.mcap",
                                    "--out", folder / "out", "--detector", "none"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(Recording, ADiskThatIsFullCostsTheRestOfIt) {
  if (kSanitized) GTEST_SKIP() << "too few frames to fill a disk of more than one chunk";
  const TemporaryFolder folder;
  const std::string command = fmt::format(
      "ulimit -f 6000; '{}' run '{}' --detector none --out '{}' --record '{}'", YDD_BINARY,
      room().string(), (folder / "out").string(), (folder / "walk.mcap").string());
  const Outcome outcome = run_program({"bash", "-c", command});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("walk.mcap: cannot be written"));
  EXPECT_THAT(outcome.err, HasSubstr("; nothing more is recorded"));
  EXPECT_EQ(summary_of(folder / "out").at("frames_processed"), kFrames);
  const auto kept = open_sequence(folder / "walk.mcap");
  ASSERT_TRUE(kept.ok()) << kept.error().message;
  EXPECT_GT(kept->size(), 2U);
  EXPECT_LT(kept->size(), static_cast<std::size_t>(kFrames));
}

/// The messages of an MCAP file by topic, as it says they are: chunks of zstd or none.
std::map<std::string, std::vector<std::string>> messages_of(const fs::path& file) {
  const std::string bytes = text_of(file);
  std::map<std::string, std::vector<std::string>> out;
  std::map<std::uint64_t, std::string> topics;
  const auto number = [](std::string_view text, std::size_t at, std::size_t size) {
    return bags::little_endian(text.substr(at, size));
  };
  const std::function<void(std::string_view)> walk = [&](std::string_view text) {
    for (std::size_t at = 0; at + 9 <= text.size();) {
      const int op = text[at];
      const std::string_view body = text.substr(at + 9, number(text, at + 1, 8));
      at += 9 + body.size();
      if (op == 4) topics[number(body, 0, 2)] = body.substr(8, number(body, 4, 4));
      if (op == 5) out[topics.at(number(body, 0, 2))].emplace_back(body.substr(22));
      if (op == 15) return;
      if (op != 6) continue;
      const std::uint64_t name = number(body, 28, 4), size = number(body, 16, 8);
      const std::string_view packed = body.substr(32 + name + 8);
      if (name == 0) {
        walk(packed);
      } else {
        walk(bags::decompressed(body.substr(32, name), packed, size).value());
      }
    }
  };
  walk(std::string_view(bytes).substr(8));
  return out;
}

TEST(Foxglove, GetsPicturesPosesPointsAndPeople) {
  const TemporaryFolder folder;
  const Outcome outcome =
      ydd_slam({"run", busy_room(), "--detections", busy_room() / "detections.jsonl", "--out",
                folder / "out", "--mcap", folder / "walk.mcap", "--max-frames", "12"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto bag = open_bag(folder / "walk.mcap").value();
  EXPECT_EQ(bag->incomplete(), "");
  ASSERT_EQ(bag->topics().size(), 5U);
  EXPECT_EQ(bag->topics()[1].type, "foxglove.PoseInFrame as json");
  const auto messages = messages_of(folder / "walk.mcap");
  const json summary = summary_of(folder / "out");
  EXPECT_EQ(messages.at("/image").size(), summary.at("frames_processed"));
  EXPECT_GE(messages.at("/points").size(), 1U);
  const json pose = json::parse(messages.at("/pose").back());
  EXPECT_EQ(pose.at("frame_id"), "world");
  const StampedPoses trajectory = read_tum_trajectory(folder / "out/trajectory.tum").value();
  const std::int64_t stamp_ns = pose.at("timestamp").at("sec").get<std::int64_t>() * 1'000'000'000 +
                                pose.at("timestamp").at("nsec").get<std::int64_t>();
  EXPECT_EQ(stamp_ns, trajectory.back().stamp.ns);
  EXPECT_NEAR(pose.at("pose").at("position").at("x"),
              trajectory.back().T_world_camera.translation().x(), 0.02);
  const json image = json::parse(messages.at("/image").front());
  EXPECT_EQ(image.at("format"), "jpeg");
  EXPECT_TRUE(image.at("data").get<std::string>().starts_with("/9j/")) << "a JPEG in base64";
  const json points = json::parse(messages.at("/points").front());
  EXPECT_EQ(points.at("point_stride"), 12);
  EXPECT_GT(points.at("data").get<std::string>().size(), 100U * 16);
  EXPECT_EQ(messages.at("/tf").size(), messages.at("/pose").size() + 1);
  std::size_t people = 0;
  for (const std::string& scene : messages.at("/tracks")) {
    const json update = json::parse(scene);
    EXPECT_EQ(update.at("deletions").at(0).at("type"), 1);
    people += update.at("entities").size();
    for (const json& entity : update.at("entities")) {
      EXPECT_GT(entity.at("cubes").at(0).at("size").at("y"), 0.2);
    }
  }
  EXPECT_GT(people, 0U);
}

#ifndef YDD_OPENNI2_RUNTIME

TEST(Cameras, AreMissedInOneLine) {
  for (const std::vector<std::string>& call :
       {std::vector<std::string>{"cameras"}, {"run", "openni2", "--detector", "none"}}) {
    const Outcome outcome = ydd_slam(call);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("built without OpenNI2; install libopenni2-dev"));
  }
}

#else

/// Frames of the room for the driver, once for all tests.
fs::path frames_file() {
  const fs::path file = room().parent_path() / "openni2-frames";
  if (fs::exists(file)) return file;
  const Sequence frames = open_sequence(room()).value();
  const Camera camera = find_camera(frames.recording()).value();
  std::string out;
  const auto put = [&](const void* data, std::size_t size) {
    out.append(static_cast<const char*>(data), size);
  };
  const auto count = static_cast<std::int32_t>(std::min<std::size_t>(30, frames.size()));
  for (const std::int32_t value : {camera.width_px, camera.height_px, count}) put(&value, 4);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const RgbdFrame frame = frames.read(i, camera).value();
    const std::int64_t stamp_us = frame.stamp.ns / 1000;
    put(&stamp_us, 8);
    const std::size_t n = std::size_t(camera.width_px) * std::size_t(camera.height_px);
    for (std::size_t j = 0; j < n; ++j) {
      const Bgr& pixel = frame.colour.data()[j];
      for (const int channel : {2, 1, 0}) put(&pixel[static_cast<std::size_t>(channel)], 1);
    }
    put(to_raw_depth(frame.depth_m, 1000).data(), 2 * n);
  }
  EXPECT_TRUE(write_file_atomically(file, out));
  return file;
}

class Cameras : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    ::setenv("LD_LIBRARY_PATH", YDD_OPENNI2_RUNTIME, 1);  // NOLINT(concurrency-mt-unsafe)
  }
  /// The camera that the next programs find; without frames: none.
  void plug_in(const std::string& script) {
    std::ofstream(folder_ / "script") << "frames " << frames_file().string() << "\n" << script;
    // NOLINTNEXTLINE(concurrency-mt-unsafe): the test has no other thread
    ::setenv("YDD_SIMULATED_CAMERA", (folder_ / "script").c_str(), 1);
  }
  void plug_out() { ::unsetenv("YDD_SIMULATED_CAMERA"); }  // NOLINT(concurrency-mt-unsafe)

  Outcome run(const std::string& camera, const std::vector<std::string>& options) {
    std::vector<std::string> all = {"run", camera, "--detector", "none", "--out", folder_ / "out"};
    all.insert(all.end(), options.begin(), options.end());
    return ydd_slam(all);
  }
  std::string error_of(const std::string& camera, const std::vector<std::string>& options = {}) {
    const Outcome outcome = run(camera, options);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    return outcome.err;
  }

  TemporaryFolder folder_;
};

TEST_F(Cameras, AreListedWithTheirModes) {
  plug_in("");
  const Outcome outcome = ydd_slam({"cameras"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out,
            "openni2:simulated@1  Ydd Simulated\n"
            "  colour  320x240@30, 640x480@15\n"
            "  depth   160x120@30, 320x240@30\n");
  const json listed = json::parse(ydd_slam({"cameras", "--json"}).out);
  EXPECT_EQ(listed.at(0).at("source"), "openni2:simulated@1");
  EXPECT_EQ(listed.at(0).at("depth"), json({"160x120@30", "320x240@30"}));
  plug_out();
  EXPECT_THAT(ydd_slam({"cameras"}).out, HasSubstr("no camera is plugged in"));
}

/// Which frame of the room this is, by its colour; -1: none.
int source_of(const RgbdFrame& frame, const Sequence& sequence, const Camera& camera) {
  const std::size_t n = std::size_t(camera.width_px) * std::size_t(camera.height_px);
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const RgbdFrame other = sequence.read(i, camera).value();
    if (std::equal(frame.colour.data(), frame.colour.data() + n, other.colour.data())) {
      EXPECT_NEAR(frame.depth_m(100, 100), other.depth_m(100, 100), 0.00051);
      EXPECT_NEAR(frame.depth_m(200, 120), other.depth_m(200, 120), 0.00051);
      return static_cast<int>(i);
    }
  }
  return -1;
}

TEST_F(Cameras, ARunIsRecordedAndRunsAgainWithTheSameResult) {
  plug_in("pace_hz 10 repeat 20 depth_shift_us 4000 no_sync 1");
  const Outcome live =
      run("openni2", {"--record", folder_ / "walk.mcap", "--deterministic", "--max-frames", "15"});
  ASSERT_EQ(live.exit_code, 0) << live.err;
  EXPECT_THAT(live.err, HasSubstr("'Ydd Simulated' (simulated@1), 320x240@30"));
  EXPECT_THAT(live.err, HasSubstr("the camera gave "));
  const json summary = summary_of(folder_ / "out");
  EXPECT_EQ(summary.at("frames_processed"), 15);
  EXPECT_EQ(summary.at("sequence"), "openni2");
  EXPECT_EQ(summary.at("camera").at("unpaired"), 0);
  EXPECT_GE(summary.at("camera").at("arrived"), 15);
  EXPECT_TRUE(fs::exists(folder_ / "out/report.html"));

  const Outcome again = ydd_slam({"run", folder_ / "walk.mcap", "--out", folder_ / "again",
                                  "--deterministic", "--detector", "none"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(text_of(folder_ / "out/trajectory.tum"), text_of(folder_ / "again/trajectory.tum"));
  EXPECT_EQ(summary_of(folder_ / "again").at("frames_tracked"), summary.at("frames_tracked"));

  // What came: the room's own pixels, not mirrored, depth laid over colour, 33 ms apart by the
  // camera's clock at whatever pace they came.
  const Sequence recorded = open_sequence(folder_ / "walk.mcap").value();
  const Camera camera = find_camera(recorded.recording()).value();
  EXPECT_NEAR(camera.fx_px, 535.4 / 2, 1e-3);
  const Sequence source = open_sequence(room()).value();
  const Camera source_camera = find_camera(source.recording()).value();
  ASSERT_EQ(recorded.size(), 15U);
  int before = -1;
  for (std::size_t i = 0; i < recorded.size(); i += 7) {
    const int number = source_of(recorded.read(i, camera).value(), source, source_camera);
    EXPECT_GE(number, 0);
    if (!kSanitized) {  // slow programs see the room go round
      EXPECT_GT(number, before);
    }
    before = number;
  }
  const double step_s = seconds_between(recorded.entry(0).stamp, recorded.entry(1).stamp);
  EXPECT_NEAR(step_s / 0.033333, std::round(step_s / 0.033333), 1e-3);
}

TEST_F(Cameras, ThatAreUnpluggedAreWaitedFor) {
  plug_in("pace_hz 20 repeat 20 unplug_after 12 away_ms 700");
  const Outcome outcome = run("openni2", {"--max-frames", "25", "--record", folder_ / "walk.mcap"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err,
              HasSubstr("warning: openni2: the camera 'Ydd Simulated' (simulated@1) was unplugged; "
                        "waiting for it"));
  EXPECT_THAT(outcome.err, HasSubstr("openni2: the camera is back after "));
  const json summary = summary_of(folder_ / "out");
  EXPECT_EQ(summary.at("camera").at("unplugged"), 1);
  EXPECT_EQ(summary.at("frames_processed"), 25);
  EXPECT_TRUE(summary.at("complete"));
  // Time goes on.
  const Sequence recorded = open_sequence(folder_ / "walk.mcap").value();
  ASSERT_EQ(recorded.size(), 25U);
  double longest_s = 0;
  for (std::size_t i = 1; i < recorded.size(); ++i) {
    longest_s =
        std::max(longest_s, seconds_between(recorded.entry(i - 1).stamp, recorded.entry(i).stamp));
  }
  EXPECT_GT(longest_s, 0.5);
}

TEST_F(Cameras, ThatStandStillAreWaitedFor) {
  // Longer than it takes to track what still waits.
  plug_in(fmt::format("pace_hz 20 repeat 20 pause_after 8 pause_ms {}", kSanitized ? 15000 : 3500));
  const Outcome outcome = run("openni2:simulated@1", {"--max-frames", "14"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("warning: openni2: no picture for 2 s; waiting"));
  EXPECT_THAT(outcome.err, HasSubstr("openni2: pictures come again"));
  EXPECT_EQ(summary_of(folder_ / "out").at("camera").at("pauses"), 1);
}

TEST_F(Cameras, DropWhatNobodyTakesInTime) {
  plug_in("pace_hz 5000 repeat 4000");
  const Outcome outcome = run("openni2", {"--max-frames", "60"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json camera = summary_of(folder_ / "out").at("camera");
  EXPECT_GT(camera.at("dropped"), 0);
  EXPECT_EQ(summary_of(folder_ / "out").at("frames_dropped"), camera.at("dropped"));
  EXPECT_THAT(outcome.err, HasSubstr("were dropped: tracking was slower"));
}

/// SIGTERM, as a shell's background jobs ignore what Ctrl-C sends; both are handled alike.
std::vector<std::string> ended_after(int seconds, const std::vector<std::string>& arguments) {
  std::vector<std::string> out = {"timeout", "--preserve-status",     "-k",      "60", "-s",
                                  "TERM",    std::to_string(seconds), YDD_BINARY};
  out.insert(out.end(), arguments.begin(), arguments.end());
  return out;
}

TEST_F(Cameras, ASignalLeavesTheResultsAndTheRecording) {
  plug_in("pace_hz 20 repeat 400");
  const Outcome outcome = run_program(
      ended_after(kSanitized ? 30 : 6, {"run", "openni2", "--detector", "none", "--out",
                                        folder_ / "out", "--record", folder_ / "walk.mcap"}));
  EXPECT_EQ(outcome.exit_code, 128 + SIGTERM) << outcome.err;
  const json summary = summary_of(folder_ / "out");
  EXPECT_THAT(summary.at("incomplete").get<std::string>(), HasSubstr("interrupted by SIGTERM"));
  EXPECT_EQ(open_sequence(folder_ / "walk.mcap")->size(), summary.at("frames_processed"));
}

TEST_F(Cameras, ACameraThatGivesNothingIsLeftByASignal) {
  plug_in("pace_hz 20 pause_after 0 pause_ms 60000");
  const Outcome outcome = run_program(ended_after(
      kSanitized ? 15 : 4, {"run", "openni2", "--detector", "none", "--out", folder_ / "out"}));
  EXPECT_EQ(outcome.exit_code, 128 + SIGTERM) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("interrupted by SIGTERM before the first frame"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(Cameras, WhatTheyCannotDoIsOneLine) {
  plug_out();
  EXPECT_THAT(error_of("openni2"), HasSubstr("no camera is plugged in"));
  plug_in("");
  EXPECT_THAT(error_of("openni2:2bc5/0401@1/7"),
              HasSubstr("no camera '2bc5/0401@1/7' can be opened"));
  EXPECT_THAT(error_of("openni2", {"--mode", "640x480@15"}),
              HasSubstr("has no depth in 640x480@15 (--mode); there are: 160x120@30, 320x240@30"));
  EXPECT_THAT(error_of("openni2", {"--mode", "wide"}), HasSubstr("expected a mode such as"));
  EXPECT_THAT(error_of("openni2", {"--depth-offset", "0.02"}), HasSubstr("--depth-offset"));
  EXPECT_THAT(error_of("openni2", {"--camera", "tum_fr1"}), HasSubstr("'tum_fr1' is 640x480"));
  plug_in("no_registration 1");
  EXPECT_THAT(error_of("openni2"), HasSubstr("cannot lay depth over colour"));
  plug_in("no_depth 1");
  EXPECT_THAT(error_of("openni2"), HasSubstr("has no depth"));
  plug_in("no_lens 1");
  EXPECT_THAT(error_of("openni2"), HasSubstr("name a camera file with --camera"));
}

TEST_F(Cameras, OnlyRunLooksThroughThem) {
  plug_in("");
  const Outcome outcome = ydd_slam({"convert", "openni2", folder_ / "x"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("is a camera, which only 'run' looks through"));
}

#endif

}  // namespace
}  // namespace ydd::e2e
