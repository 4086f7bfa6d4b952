// SPDX-License-Identifier: Apache-2.0
//
// Maps that last, through the binary: saved, killed, gone on with, localised in, exported, merged.
#include <csignal>
#include <cstdlib>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "small_world.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/evaluation/ate.h"
#include "ydd/image/decode.h"
#include "ydd/map_files/map_file.h"
#include "ydd/sources/source.h"

namespace ydd::e2e {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using Arguments = std::vector<std::string>;

constexpr int kFirst = kFrames * 2 / 3;  ///< frames of a first run

std::string bytes_of(const fs::path& file) { return read_file(file).value(); }

/// `ydd-slam run SEQUENCE --out OUT ...`, which must succeed.
void run(const fs::path& sequence, const fs::path& out, Arguments options) {
  options.insert(options.begin(), {"run", sequence.string(), "--out", out.string(), "--quiet"});
  const Outcome outcome = ydd_slam(options);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
}

json info(const fs::path& map) {
  const Outcome outcome = ydd_slam({"map", "info", map.string(), "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.exit_code == 0 ? json::parse(outcome.out) : json();
}

StampedPoses trajectory_of(const fs::path& out) {
  return read_tum_trajectory(out / "trajectory.tum").value();
}

double ate_m(const fs::path& sequence, const StampedPoses& estimate) {
  const auto truth = read_tum_trajectory(sequence / "groundtruth.txt");
  const auto ate = absolute_trajectory_error(truth.value(), estimate);
  if (!ate) ADD_FAILURE() << ate.error().message;
  return ate ? ate->statistics_m.rmse : std::nan("");
}

/// The first one, and of the second what comes after it: right only if both are in one world.
StampedPoses joined(StampedPoses first, const StampedPoses& second) {
  const Timestamp end = first.back().stamp;
  std::copy_if(second.begin(), second.end(), std::back_inserter(first),
               [&](const StampedPose& pose) { return pose.stamp > end; });
  return first;
}

std::string number(int n) { return fmt::format("{}", n); }

TEST(Maps, AreGoneOnWithInTheirOwnWorld) {
  const TemporaryFolder folder;
  const std::string map = folder / "room.map";
  run(room(), folder / "a", {"--deterministic", "--max-frames", number(kFirst), "--save-map", map});
  const json before = info(map);
  EXPECT_EQ(before.at("keyframes"),
            json::parse(bytes_of(folder / "a/summary.json")).at("keyframes_kept"));
  ASSERT_EQ(before.at("maps").size(), 1U);
  EXPECT_EQ(before.at("maps").at(0).at("pictures"), before.at("keyframes"));
  run(room(), folder / "b",
      {"--deterministic", "--start-frame", number(kFirst - 2), "--map", map, "--save-map", map});
  const StampedPoses second = trajectory_of(folder / "b");
  EXPECT_EQ(second.size(), static_cast<std::size_t>(kFrames - kFirst + 2));
  EXPECT_EQ(info(map).at("maps").size(), 1U);
  EXPECT_GE(info(map).at("keyframes"), before.at("keyframes"));
  if (kSanitized) return;
  EXPECT_LT(ate_m(room(), joined(trajectory_of(folder / "a"), second)), 0.015);
}

TEST(Maps, LocalizationOnlyLeavesTheFileAlone) {
  const TemporaryFolder folder;
  const std::string map = folder / "room.map";
  run(room(), folder / "a", {"--deterministic", "--save-map", map});
  const std::string before = bytes_of(map);
  run(room(), folder / "b", {"--map", map, "--localization-only"});
  EXPECT_TRUE(bytes_of(map) == before);
  const StampedPoses trajectory = trajectory_of(folder / "b");
  EXPECT_EQ(trajectory.size(), static_cast<std::size_t>(kFrames));
  EXPECT_LT(ate_m(room(), trajectory), 0.012);
  const json summary = json::parse(bytes_of(folder / "b/summary.json"));
  EXPECT_EQ(summary.at("keyframes_inserted"), 0);
  // The same with only a part of the map in memory.
  if (kSanitized) return;  // too few frames for a second keyframe
  const std::size_t keyframes = load_map(map).value().keyframes().size();
  ASSERT_GE(keyframes, 2U);
  run(room(), folder / "c",
      {"--deterministic", "--map", map, "--localization-only", "--set",
       "map.near_keyframes=" + number(static_cast<int>(keyframes / 2))});
  EXPECT_TRUE(bytes_of(map) == before);
  EXPECT_EQ(trajectory_of(folder / "c").size(), static_cast<std::size_t>(kFrames));
  EXPECT_LT(ate_m(room(), trajectory_of(folder / "c")), 0.012);
}

TEST(Maps, OfOnePlaceAreMergedAndOfTwoKeptApart) {
  if (kSanitized) GTEST_SKIP() << "too few frames for a loop";
  const TemporaryFolder folder;
  run(room(), folder / "a", {"--max-frames", "45", "--save-map", folder / "a.map"});
  run(room(), folder / "b", {"--start-frame", "15", "--save-map", folder / "b.map"});
  const Outcome merged = ydd_slam({"map", "merge", folder / "a.map", folder / "b.map", "--out",
                                   folder / "c.map", "--set", "loop.min_score_ratio=0.5"});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_THAT(merged.out, HasSubstr("merged map 1 onto map 0"));
  EXPECT_EQ(info(folder / "c.map").at("maps").size(), 1U);
  const fs::path other = small_world("other", {"--frames", "20", "--seed", "77"});
  run(other, folder / "o", {"--camera", room() / "camera.yaml", "--save-map", folder / "o.map"});
  const Outcome apart =
      ydd_slam({"map", "merge", folder / "a.map", folder / "o.map", "--out", folder / "d.map"});
  ASSERT_EQ(apart.exit_code, 0) << apart.err;
  EXPECT_THAT(apart.out, HasSubstr("no common place"));
  EXPECT_EQ(info(folder / "d.map").at("maps").size(), 2U);
  // Three at once, then some of it in a file of its own, and without what was seen once.
  const Outcome three =
      ydd_slam({"map", "merge", folder / "a.map", folder / "o.map", folder / "b.map", "--out",
                folder / "e.map", "--set", "loop.min_score_ratio=0.5"});
  ASSERT_EQ(three.exit_code, 0) << three.err;
  EXPECT_THAT(three.out, HasSubstr("o.map: no common place"));
  EXPECT_THAT(three.out, HasSubstr("b.map: merged map 2 onto map 0"));
  EXPECT_THAT(three.out, HasSubstr("keyframes overlap"));
  const Outcome split =
      ydd_slam({"map", "split", folder / "e.map", "--which", "1", "--out", folder / "f.map"});
  ASSERT_EQ(split.exit_code, 0) << split.err;
  EXPECT_EQ(info(folder / "f.map").at("maps").size(), 1U);
  EXPECT_EQ(info(folder / "f.map").at("keyframes"), info(folder / "o.map").at("keyframes"));
  const Outcome pruned = ydd_slam({"map", "prune", folder / "e.map", "--out", folder / "g.map"});
  ASSERT_EQ(pruned.exit_code, 0) << pruned.err;
  EXPECT_LT(info(folder / "g.map").at("points"), info(folder / "e.map").at("points"));
  for (const char* const name : {"e.map", "f.map", "g.map"}) {
    const Outcome check = ydd_slam({"map", "check", folder / name});
    EXPECT_EQ(check.exit_code, 0) << check.err;
    EXPECT_THAT(check.out, HasSubstr(": sound: "));
  }
  const Outcome none =
      ydd_slam({"map", "split", folder / "e.map", "--which", "9", "--out", folder / "h.map"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("holds no map number 9"));
  EXPECT_FALSE(fs::exists(folder / "h.map"));
}

// --- clouds -----------------------------------------------------------------------------------

std::vector<Eigen::Vector3d> read_dense_ply(const fs::path& file) {
  const std::string bytes = bytes_of(file);
  const std::size_t start = bytes.find("end_header\n") + 11;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t at = start; at + 15 <= bytes.size(); at += 15) {
    float xyz[3];
    std::memcpy(xyz, bytes.data() + at, sizeof xyz);
    points.emplace_back(xyz[0], xyz[1], xyz[2]);
  }
  return points;
}

/// What an empty room looks like from each frame of its path: exact depth.
struct EmptyRoom {
  Camera camera;
  std::vector<DepthImage> depth_m;
  std::vector<SE3> T_camera_first;  ///< from the first camera's frame

  explicit EmptyRoom(const fs::path& sequence)
      : camera(find_camera(sequence.string(), "").value()) {
    const Sequence frames = open_sequence(sequence).value();
    const StampedPoses truth = read_tum_trajectory(sequence / "groundtruth.txt").value();
    for (std::size_t i = 0; i < frames.size(); i += 6) {
      depth_m.push_back(frames.read(i, camera).value().depth_m);
      T_camera_first.push_back(truth.at(i).T_world_camera.inverse() * truth.front().T_world_camera);
    }
  }

  /// Whether the point hangs in the air before everything that some frame sees around it.
  bool hangs_in_the_air(const Eigen::Vector3d& p_first) const {
    for (std::size_t i = 0; i < depth_m.size(); ++i) {
      const Eigen::Vector3d p = T_camera_first[i] * p_first;
      if (p.z() < 0.3) continue;
      const Eigen::Vector2d px = camera.project(p);
      const int x = static_cast<int>(std::lround(px.x()));
      const int y = static_cast<int>(std::lround(px.y()));
      if (!depth_m[i].contains(x - 4, y - 4) || !depth_m[i].contains(x + 4, y + 4)) continue;
      float nearest_m = HUGE_VALF;
      for (int dy = -4; dy <= 4; ++dy) {
        for (int dx = -4; dx <= 4; ++dx) {
          nearest_m = std::min(nearest_m, depth_m[i](x + dx, y + dy));
        }
      }
      if (p.z() < nearest_m - 0.25) return true;
    }
    return false;
  }
};

/// Share of the dense cloud's points that hang in the air of the empty room.
double share_in_the_air(const fs::path& map, const TemporaryFolder& folder,
                        const EmptyRoom& truth) {
  const fs::path ply = folder / "cloud.ply";
  const Outcome exported =
      ydd_slam({"map", "export", map.string(), "--dense", ply.string(), "--voxel", "0.03"});
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  const std::vector<Eigen::Vector3d> points = read_dense_ply(ply);
  EXPECT_GT(points.size(), 3000U);
  const auto hanging = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
    return truth.hangs_in_the_air(p);
  });
  return static_cast<double>(hanging) / static_cast<double>(points.size());
}

TEST(Maps, TheDenseCloudHasNoPeopleInIt) {
  const TemporaryFolder folder;
  const EmptyRoom truth(small_world("clear", {"--frames", number(kFrames)}));
  const auto share = [&](const std::string& variant) {
    const fs::path map = folder / (variant + ".map");
    run(busy_room(), folder / variant,
        {"--deterministic", "--detections", busy_room() / "detections.jsonl", "--dynamic", variant,
         "--save-map", map, "--set", "map.behind_people=true"});  // else boxes are all that counts
    return share_in_the_air(map, folder, truth);
  };
  const double full = share("full");
  RecordProperty("hanging_per_million", static_cast<int>(1e6 * full));
  EXPECT_LT(full, 0.001);
  if (!kSanitized) {
    EXPECT_GT(share("off"), 0.05) << "the test would not notice people";
  }
}

TEST(Maps, AreExported) {
  const TemporaryFolder folder;
  run(few_frames(), folder / "a", {"--deterministic", "--save-map", folder / "a.map"});
  const Arguments wanted = {
      "map",     "export",         folder / "a.map", "--sparse",      folder / "s.ply",
      "--dense", folder / "d.ply", "--keyframes",    folder / "k.tum"};
  ASSERT_EQ(ydd_slam(wanted).exit_code, 0);
  EXPECT_EQ(bytes_of(folder / "k.tum"), bytes_of(folder / "a/keyframes.tum"));
  EXPECT_THAT(bytes_of(folder / "s.ply"), testing::StartsWith("ply\nformat binary_little_endian"));
  const std::string dense = bytes_of(folder / "d.ply");
  ASSERT_EQ(ydd_slam(wanted).exit_code, 0);
  EXPECT_TRUE(bytes_of(folder / "d.ply") == dense);
  const Outcome octomap =
      ydd_slam({"map", "export", folder / "a.map", "--octomap", folder / "o.bt"});
  if (octomap.exit_code == 0) {
    EXPECT_THAT(bytes_of(folder / "o.bt"), testing::StartsWith("# Octomap OcTree binary file"));
  } else {
    EXPECT_THAT(octomap.err, HasSubstr("liboctomap-dev"));
  }
  // Without pictures there is nothing to make a cloud of.
  run(few_frames(), folder / "b", {"--save-map", folder / "b.map", "--set", "map.pictures=false"});
  const Outcome none = ydd_slam({"map", "export", folder / "b.map", "--dense", folder / "x.ply"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("map.pictures"));
  EXPECT_LT(fs::file_size(folder / "b.map"), fs::file_size(folder / "a.map"));
}

TEST(Maps, TheFloorIsExportedForARobot) {
  const TemporaryFolder folder;
  run(room(), folder / "a", {"--deterministic", "--save-map", folder / "a.map"});
  const Arguments wanted = {"map", "export", folder / "a.map", "--grid", folder / "floor.pgm"};
  const Outcome exported = ydd_slam(wanted);
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  const std::string pgm = bytes_of(folder / "floor.pgm");
  EXPECT_THAT(pgm, testing::StartsWith("P5\n"));
  EXPECT_GT(std::count(pgm.begin(), pgm.end(), '\0'), 50) << "occupied";
  EXPECT_GT(std::count(pgm.begin(), pgm.end(), '\xFE'), 200) << "free";
  const std::string yaml = bytes_of(folder / "floor.yaml");
  EXPECT_THAT(yaml, HasSubstr("image: 'floor.pgm'"));
  EXPECT_THAT(yaml, HasSubstr("occupied_thresh: 0.65"));
  ASSERT_EQ(ydd_slam(wanted).exit_code, 0);
  EXPECT_TRUE(bytes_of(folder / "floor.pgm") == pgm);
  const Outcome nowhere =
      ydd_slam({"map", "export", folder / "a.map", "--grid", folder / "none/floor.pgm"});
  EXPECT_EQ(nowhere.exit_code, 1);
  ASSERT_EQ(nowhere.error_lines().size(), 1U) << nowhere.err;
  const Outcome fine = ydd_slam({"map", "export", folder / "a.map", "--grid", folder / "f.pgm",
                                 "--max-depth", "100", "--grid-resolution", "0.005"});
  EXPECT_EQ(fine.exit_code, 1);
  EXPECT_THAT(fine.err, HasSubstr("choose larger cells"));
  EXPECT_FALSE(fs::exists(folder / "f.pgm"));
}

// --- what goes wrong --------------------------------------------------------------------------

TEST(Maps, WhatIsNoMapIsOneClearLineAndStays) {
  const TemporaryFolder folder;
  std::ofstream(folder / "letter") << std::string(5000, 'x');
  const std::string before = bytes_of(folder / "letter");
  const std::string sequence = few_frames();
  const std::string letter = folder / "letter";
  for (const Arguments& arguments :
       {Arguments{"map", "info", letter}, Arguments{"map", "export", letter, "--sparse", "x.ply"},
        Arguments{"map", "check", letter},
        Arguments{"map", "prune", letter, "--out", folder / "out.map"},
        Arguments{"map", "split", letter, "--which", "0", "--out", folder / "out.map"},
        Arguments{"map", "merge", letter, letter, "--out", folder / "out.map"},
        Arguments{"run", sequence, "--map", letter},
        Arguments{"run", sequence, "--save-map", letter}}) {
    const Outcome outcome = ydd_slam(arguments, folder.path());
    EXPECT_EQ(outcome.exit_code, 1);
    ASSERT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("is not a map file of ydd-slam"));
    EXPECT_TRUE(bytes_of(letter) == before);
    EXPECT_FALSE(fs::exists(folder / "out.map"));
  }
}

TEST(Maps, AnotherCameraIsOneClearLine) {
  const TemporaryFolder folder;
  run(few_frames(), folder / "a", {"--save-map", folder / "a.map"});
  const Outcome camera = ydd_slam({"run", few_frames(), "--map", folder / "a.map", "--camera",
                                   "tum_fr1", "--out", folder / "b"});
  EXPECT_EQ(camera.exit_code, 1);
  ASSERT_EQ(camera.error_lines().size(), 1U) << camera.err;
  EXPECT_THAT(camera.err, HasSubstr("a.map: made with another camera: width is 320"));
  const Outcome pyramid = ydd_slam({"run", few_frames(), "--map", folder / "a.map", "--set",
                                    "orb.levels=5", "--out", folder / "b"});
  EXPECT_THAT(pyramid.err, HasSubstr("orb.levels=8"));
}

TEST(Maps, WrongCallsAreUsageErrors) {
  EXPECT_EQ(ydd_slam({"run", few_frames(), "--localization-only"}).exit_code, 2);
  EXPECT_EQ(ydd_slam({"run", few_frames(), "--map", "a", "--localization-only", "--save-map", "b"})
                .exit_code,
            2);
  EXPECT_EQ(ydd_slam({"map", "export", "a.map"}).exit_code, 2);
  EXPECT_EQ(ydd_slam({"map", "export", "a.map", "--grid", "a.png"}).exit_code, 2);
  EXPECT_EQ(ydd_slam({"map", "export", "a.map", "--min-height", "1"}).exit_code, 2);
  EXPECT_EQ(ydd_slam({"map", "export", "a.map", "--grid", "a.pgm", "--min-height", "2"}).exit_code,
            2);
  EXPECT_EQ(ydd_slam({"map"}).exit_code, 2);
}

// --- kill -9 ----------------------------------------------------------------------------------

/// Runs the binary and kills it after so long. True if it was still running.
bool killed_after(std::chrono::milliseconds after, Arguments arguments, const fs::path& folder) {
  arguments.insert(arguments.begin(), YDD_BINARY);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const std::string log = folder / "killed.log";
  const pid_t child = ::fork();
  if (child == 0) {
    const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (out < 0 || ::dup2(out, STDOUT_FILENO) < 0 || ::dup2(out, STDERR_FILENO) < 0) ::_exit(126);
    ::execv(argv.front(), argv.data());
    ::_exit(127);
  }
  std::this_thread::sleep_for(after);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}

/// YDD_KILLS=100 for the long version.
int kills() {
  const char* const wanted = std::getenv("YDD_KILLS");
  return wanted ? std::atoi(wanted) : 4;
}

TEST(Maps, SurviveBeingKilledAtAnyMoment) {
  const TemporaryFolder folder;
  const std::string map = folder / "room.map";
  const Arguments arguments = {"run",        room(), "--out", folder / "a",          "--quiet",
                               "--save-map", map,    "--set", "map.autosave_s=0.001"};
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(ydd_slam(arguments).exit_code, 0);
  std::chrono::nanoseconds whole = std::chrono::steady_clock::now() - start;
  std::mt19937 random(7);
  int killed = 0;
  int half_saved = 0;
  for (int i = 0; i < kills(); ++i) {
    Arguments again = arguments;
    again.insert(again.end(), {"--map", map});
    const auto after =
        std::chrono::duration_cast<std::chrono::milliseconds>(whole * (5 + random() % 85) / 100);
    if (killed_after(after, again, folder.path())) {
      ++killed;
    } else {
      whole /= 3;  // the machine has less to do than when this was measured
    }
    half_saved += fs::exists(map + "-journal") || fs::exists(map + ".new") ? 1 : 0;
    ASSERT_TRUE(fs::exists(map)) << "the file was lost";
    const json held = info(map);
    ASSERT_FALSE(held.is_null()) << "kill " << i;
    ASSERT_GT(held.at("keyframes"), 0);
  }
  RecordProperty("killed", killed);
  RecordProperty("killed_while_saving", half_saved);
  EXPECT_GT(killed, 0);
  // What is left can be gone on with.
  run(room(), folder / "b", {"--map", map, "--save-map", map});
  EXPECT_EQ(trajectory_of(folder / "b").size(), static_cast<std::size_t>(kFrames));
  EXPECT_LT(ate_m(room(), trajectory_of(folder / "b")), 0.02);
}

}  // namespace
}  // namespace ydd::e2e
