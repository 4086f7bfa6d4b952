// SPDX-License-Identifier: Apache-2.0
//
// The same frames from recordings of different kinds: the same trajectory, and the truth is found.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "accuracy.h"
#include "small_world.h"
#include "ydd/bags/bags_testing.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/image/decode.h"
#include "ydd/messages/wire_testing.h"
#include "ydd/sources/source.h"

namespace ydd::e2e {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::string text_of(const fs::path& file) { return read_file(file).value(); }

Outcome run(const fs::path& source, const fs::path& out, std::vector<std::string> options = {}) {
  options.insert(options.begin(), {"run", source.string(), "--out", out.string(), "--deterministic",
                                   "--detector", "none"});
  Outcome outcome = ydd_slam(options);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome;
}

/// Depth files as millimetres.
void write_millimetres(const fs::path& from, const fs::path& to, const Camera& camera) {
  const DepthImage depth_m = load_depth(from, camera).value();
  ASSERT_TRUE(write_png(to, to_raw_depth(depth_m, 1000)));
}

/// The room with its pictures in folders of their own, named by their times, and no list.
fs::path without_lists(const fs::path& folder) {
  const Sequence frames = open_sequence(room()).value();
  for (const char* const name : {"color", "depth"}) fs::create_directories(folder / name);
  for (const SequenceEntry& entry : frames.entries()) {
    const std::string name = format_timestamp(entry.stamp) + ".png";
    fs::copy_file(entry.colour_name, folder / "color" / name);
    fs::copy_file(entry.depth_name, folder / "depth" / name);
  }
  fs::copy_file(room() / "camera.yaml", folder / "camera.yaml");
  return folder;
}

TEST(Sources, TheSameFramesGiveTheSameTrajectory) {
  const TemporaryFolder folder;
  run(room(), folder / "tum");
  const Outcome outcome = run(without_lists(folder / "pictures"), folder / "realsense");
  EXPECT_THAT(outcome.err, HasSubstr("source 'realsense'"));
  EXPECT_EQ(text_of(folder / "tum/trajectory.tum"), text_of(folder / "realsense/trajectory.tum"));
  // What it was is kept, and can be given.
  run(folder / "pictures", folder / "named", {"--source", "realsense", "--max-frames", "3"});
  EXPECT_THAT(text_of(folder / "named/config.yaml"), HasSubstr("source: realsense"));
}

/// The room as a robot of OpenLORIS would have recorded it: truth is of the robot, depth in
/// millimetres.
fs::path as_openloris(const fs::path& folder) {
  const Sequence frames = open_sequence(room()).value();
  const Camera camera = find_camera(frames.recording()).value();
  for (const char* const name : {"color", "aligned_depth"}) fs::create_directories(folder / name);
  std::ofstream colour(folder / "color.txt"), depth(folder / "aligned_depth.txt");
  for (const SequenceEntry& entry : frames.entries()) {
    const std::string name = format_timestamp(entry.stamp) + ".png";
    fs::copy_file(entry.colour_name, folder / "color" / name);
    write_millimetres(entry.depth_name, folder / "aligned_depth" / name, camera);
    colour << format_timestamp(entry.stamp) << " color/" << name << "\n";
    depth << format_timestamp(entry.depth_stamp) << " aligned_depth/" << name << "\n";
  }
  std::ofstream(folder / "sensors.yaml") << fmt::format(
      "%YAML:1.0\nd400_color_optical_frame:\n   width: {}\n   height: {}\n   fps: 30\n"
      "   intrinsics: !!opencv-matrix\n      rows: 1\n      cols: 4\n      dt: d\n"
      "      data: [ {}, {}, {}, {} ]\n",
      camera.width_px, camera.height_px, camera.fx_px, camera.cx_px, camera.fy_px, camera.cy_px);
  std::ofstream(folder / "trans_matrix.yaml")
      << "%YAML:1.0\ntrans_matrix:\n  - parent_frame: base_link\n"
         "    child_frame: d400_color_optical_frame\n"
         "    matrix: !!opencv-matrix\n      rows: 4\n      cols: 4\n      dt: d\n"
         "      data: [ 0, 0, 1, 0.5, -1, 0, 0, 0, 0, -1, 0, 1.1, 0, 0, 0, 1 ]\n";
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const SE3 T_base_camera(R, {0.5, 0, 1.1});
  StampedPoses truth = read_tum_trajectory(room() / "groundtruth.txt").value();
  for (StampedPose& pose : truth) {
    pose.T_world_camera = pose.T_world_camera * T_base_camera.inverse();
  }
  EXPECT_TRUE(write_trajectory(folder / "groundtruth.txt", truth));
  return folder;
}

TEST(Sources, TruthInAnotherFormIsLeftAsATrajectory) {
  const TemporaryFolder folder;
  const Outcome outcome = run(as_openloris(folder / "robot"), folder / "a");
  const fs::path truth = folder / "a/groundtruth.tum";
  EXPECT_THAT(outcome.out, HasSubstr("compare: ydd-slam eval " + truth.string()));
  EXPECT_EQ(json::parse(text_of(folder / "a/summary.json")).at("groundtruth"), truth.string());
  const Outcome eval = ydd_slam({"eval", truth, folder / "a/trajectory.tum", "--json"});
  ASSERT_EQ(eval.exit_code, 0) << eval.err;
  const double error_m =
      json::parse(eval.out).at("ate").at("absolute_translational_error").at("rmse");
  EXPECT_LT(error_m, 0.015);
  EXPECT_NEAR(error_m, ate_m(room(), folder / "a"), 1e-6);
  EXPECT_THAT(text_of(folder / "a/report.html"), HasSubstr("ATE"));
}

TEST(Sources, TruthThatCannotBeReadCostsTheComparisonOnly) {
  const TemporaryFolder folder;
  const fs::path robot = as_openloris(folder / "robot");
  fs::remove(robot / "trans_matrix.yaml");
  const Outcome outcome = run(robot, folder / "a", {"--max-frames", "5"});
  EXPECT_THAT(outcome.err, HasSubstr("trans_matrix.yaml"));
  EXPECT_THAT(outcome.err, HasSubstr("no ground truth"));
  EXPECT_FALSE(fs::exists(folder / "a/groundtruth.tum"));
}

/// The room as messages of a robot: colour as it is, depth in metres, no stamp rounded.
bags::WrittenMessages as_messages(Wire wire, std::size_t frames_wanted) {
  const std::string package = wire == Wire::ros1 ? "sensor_msgs/" : "sensor_msgs/msg/";
  const Sequence frames = open_sequence(room()).value();
  const Camera camera = find_camera(frames.recording()).value();
  bags::WrittenMessages out;
  for (std::size_t i = 0; i < std::min(frames_wanted, frames.size()); ++i) {
    const RgbdFrame frame = frames.read(i, camera).value();
    const auto width = static_cast<std::uint32_t>(camera.width_px);
    const auto height = static_cast<std::uint32_t>(camera.height_px);
    const std::size_t n = std::size_t{width} * height;
    const std::string_view colour(reinterpret_cast<const char*>(frame.colour.data()), 3 * n);
    const std::string_view depth(reinterpret_cast<const char*>(frame.depth_m.data()), 4 * n);
    const Timestamp late{frame.stamp.ns + 40'000'000};
    out.push_back({"/camera/color/camera_info", package + "CameraInfo", late,
                   camera_info_message(wire, frame.stamp, width, height, camera.fx_px, camera.fy_px,
                                       camera.cx_px, camera.cy_px)});
    out.push_back({"/camera/color/image_raw", package + "Image", late,
                   image_message(wire, frame.stamp, width, height, "bgr8", 3 * width, colour)});
    out.push_back({"/camera/depth_registered/image_raw", package + "Image", late,
                   image_message(wire, frame.stamp, width, height, "32FC1", 4 * width, depth)});
  }
  return out;
}

TEST(Sources, BagsGiveTheTrajectoryOfTheFolder) {
  constexpr std::size_t kSome = 12;
  const TemporaryFolder folder;
  run(room(), folder / "tum", {"--max-frames", "12"});
  const bags::WrittenMessages ros1 = as_messages(Wire::ros1, kSome);
  const bags::WrittenMessages cdr = as_messages(Wire::cdr, kSome);
  bags::write_bytes(folder / "walk.bag", bags::ros1_bag(ros1, "none"));
  bags::write_bytes(folder / "walk.mcap", bags::mcap_bag(cdr, ""));
  bags::write_sqlite_bag(folder / "walk.db3", cdr);
  for (const char* const name : {"walk.bag", "walk.mcap", "walk.db3"}) {
    run(folder / name, folder / "out");
    EXPECT_EQ(text_of(folder / "tum/trajectory.tum"), text_of(folder / "out/trajectory.tum"))
        << name;
  }
  // Decoded ahead by a thread of its own it is the same recording.
  EXPECT_EQ(ydd_slam({"run", folder / "walk.mcap", "--out", folder / "out", "--quiet", "--detector",
                      "none"})
                .exit_code,
            0);
  EXPECT_EQ(json::parse(text_of(folder / "out/summary.json")).at("frames_processed"), kSome);
  EXPECT_EQ(json::parse(text_of(folder / "out/summary.json")).at("sequence"), "walk");
}

TEST(Sources, ABagThatIsCutOffIsRunUpToThere) {
  const TemporaryFolder folder;
  const std::string whole = bags::ros1_bag(as_messages(Wire::ros1, 6), "none");
  bags::write_bytes(folder / "cut.bag", whole.substr(0, whole.size() / 2));
  const Outcome outcome = run(folder / "cut.bag", folder / "out");
  EXPECT_THAT(outcome.err, HasSubstr("warning: " + (folder / "cut.bag").string() +
                                     ": is cut off or damaged at byte"));
  EXPECT_EQ(json::parse(text_of(folder / "out/summary.json")).at("frames_tracked"), 2);
}

TEST(Sources, WhatABagLacksIsOneLineWithTheOption) {
  const TemporaryFolder folder;
  bags::WrittenMessages messages = as_messages(Wire::cdr, 2);
  std::erase_if(messages, [](const auto& m) { return m.type.ends_with("CameraInfo"); });
  bags::write_sqlite_bag(folder / "a.db3", messages);
  const auto error_of = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"run", folder / "a.db3", "--out", folder / "o", "--quiet"});
    const Outcome outcome = ydd_slam(options);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "o"));
    return outcome.err;
  };
  EXPECT_THAT(error_of({}), HasSubstr("--topic-camera-info, or give --camera"));
  EXPECT_THAT(error_of({"--topic-depth", "/x"}),
              HasSubstr("no topic '/x' with pictures; there are: /camera/color/image_raw"));
  EXPECT_THAT(
      error_of({"--camera", room() / "camera.yaml", "--topic-depth", "/camera/color/image_raw"}),
      HasSubstr("is 'bgr8'; depth is 16UC1 or 32FC1"));
}

TEST(Sources, AnyRecordingCanBeConverted) {
  const TemporaryFolder folder;
  bags::write_bytes(folder / "walk.bag", bags::ros1_bag(as_messages(Wire::ros1, 6), "none"));
  const Outcome made = ydd_slam({"convert", folder / "walk.bag", folder / "walk"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("6 frames in "));
  const Sequence frames = open_sequence(folder / "walk").value();
  ASSERT_EQ(frames.size(), 6U);
  EXPECT_EQ(frames.recording().source, "tum");
  const Camera camera = find_camera(frames.recording()).value();
  EXPECT_EQ(camera.depth_scale, 1000);  // metres became millimetres
  const Camera before = find_camera(open_recording(room()).value()).value();
  EXPECT_EQ(camera.fx_px, before.fx_px);
  const RgbdFrame a = frames.read(5, camera).value();
  const RgbdFrame b = open_sequence(room())->read(5, before).value();
  EXPECT_EQ(a.stamp, b.stamp);
  for (int x = 0; x < camera.width_px; ++x) {
    EXPECT_EQ(a.colour(x, 100), b.colour(x, 100));
    EXPECT_NEAR(a.depth_m(x, 100), b.depth_m(x, 100), 0.00051);
  }
  EXPECT_EQ(ydd_slam({"convert", folder / "walk.bag", folder / "walk"}).exit_code, 1)
      << "never over what is there";
  // Counts stay as they are, and truth comes along.
  ASSERT_EQ(ydd_slam({"convert", room(), folder / "again", "--max-frames", "2"}).exit_code, 0);
  const Sequence again = open_sequence(folder / "again").value();
  EXPECT_EQ(find_camera(again.recording())->depth_scale, before.depth_scale);
  EXPECT_EQ(again.read_depth_counts(1)->operator()(50, 60),
            open_sequence(room())->read_depth_counts(1)->operator()(50, 60));
  EXPECT_EQ(again.groundtruth()->read()->size(),
            read_tum_trajectory(room() / "groundtruth.txt")->size());
}

TEST(Sources, ANameThatIsNoneIsAUsageError) {
  const Outcome outcome = ydd_slam({"run", few_frames(), "--source", "oni"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("7scenes"));
  EXPECT_THAT(outcome.err, HasSubstr("openloris"));
}

}  // namespace
}  // namespace ydd::e2e
