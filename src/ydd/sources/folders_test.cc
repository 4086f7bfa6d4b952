// SPDX-License-Identifier: Apache-2.0
//
// Every layout of a folder but TUM's: a small one of each, told apart by itself.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/dataset/camera_file.h"
#include "ydd/sources/layouts_testing.h"
#include "ydd/sources/source.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;
using testing::EndsWith;
using testing::HasSubstr;

/// The first frame's blue and the middle's depth, through everything that reads frames.
void expect_frame(const Sequence& sequence, std::size_t i, int blue, float depth_m) {
  Camera camera = find_camera(sequence.recording()).value();
  const auto frame = sequence.read(i, camera);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_NEAR(frame->colour(5, 5)[0], blue, 2);
  EXPECT_FLOAT_EQ(frame->depth_m(5, 5), depth_m);
}

std::string error_of(const fs::path& folder, const SequenceOptions& options = {}) {
  const auto sequence = open_sequence(folder, options);
  return sequence ? "no error" : sequence.error().message;
}

class IclFolder : public LayoutTest {
 protected:
  IclFolder() {
    for (int i = 0; i < 3; ++i) {
      put_colour(fmt::format("rgb/{}.png", i), 10 + i, 640, 480);
      put_depth(fmt::format("depth/{}.png", i), 5000 + 500 * i, 640, 480);
    }
    write("associations.txt",
          "0 depth/0.png 0 rgb/0.png\n1 depth/1.png 1 rgb/1.png\n2 depth/2.png 2 rgb/2.png\n");
    // 90 degrees about x; the dataset has no pose of frame 0.
    write("livingRoom2.gt.freiburg",
          "1 1 2 3 0.70710678 0 0 0.70710678\n2 1 2.5 3 0.70710678 0 0 0.70710678\n");
  }
};

TEST_F(IclFolder, IsReadWithItsOwnCameraAndAtThirtyHertz) {
  const auto sequence = open_sequence(folder_);
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_EQ(sequence->recording().source, "icl");
  ASSERT_EQ(sequence->size(), 3U);
  EXPECT_EQ(sequence->entry(2).stamp.ns, 66'666'667);
  EXPECT_FALSE(sequence->pairing());
  const Camera camera = find_camera(sequence->recording()).value();
  EXPECT_EQ(camera.fx_px, 481.20);
  EXPECT_EQ(camera.fy_px, 480.0);  // not -480: see icl_folder.cc
  EXPECT_EQ(camera.depth_scale, 5000);
  expect_frame(*sequence, 2, 12, 1.2F);
}

TEST_F(IclFolder, ItsTruthIsReflected) {
  const auto sequence = open_sequence(folder_);
  ASSERT_TRUE(sequence->groundtruth());
  EXPECT_FALSE(sequence->groundtruth()->is_tum_file);
  const auto truth = sequence->groundtruth()->read();
  ASSERT_TRUE(truth) << truth.error().message;
  ASSERT_EQ(truth->size(), 2U);
  EXPECT_EQ(truth->at(0).stamp, sequence->entry(1).stamp);
  const SE3& T = truth->at(1).T_world_camera;
  EXPECT_TRUE(T.translation().isApprox(Eigen::Vector3d(1, -2.5, 3)));
  // Whatever a camera with y upward sees, one with y downward sees reflected: F T F.
  const Eigen::Vector3d F(1, -1, 1);
  const SE3 published(Eigen::Quaterniond(0.70710678, 0.70710678, 0, 0), {1, 2.5, 3});
  const Eigen::Vector3d p(0.3, -0.2, 2);
  const Eigen::Vector3d q = published * F.cwiseProduct(p).eval();
  EXPECT_TRUE((T * p).isApprox(F.cwiseProduct(q).eval(), 1e-6));
}

TEST_F(IclFolder, WithoutTruthItIsToldByDepthBeingFirst) {
  fs::remove(folder_ / "livingRoom2.gt.freiburg");
  EXPECT_EQ(open_sequence(folder_)->recording().source, "icl");
  EXPECT_FALSE(open_sequence(folder_)->groundtruth());
}

TEST_F(IclFolder, RealStampsAndColourFirstAreKept) {
  write("associations.txt", "1700000000.5 rgb/0.png 1700000000.5 depth/0.png\n");
  const auto sequence = open_sequence(folder_);
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_EQ(sequence->entry(0).stamp.ns, 1'700'000'000'500'000'000);
  EXPECT_THAT(sequence->entry(0).colour_name, EndsWith("rgb/0.png"));
}

class OpenLorisFolder : public LayoutTest {
 protected:
  OpenLorisFolder() {
    put_colour("color/1.png", 50);
    put_depth("aligned_depth/1.png", 1500);
    write("color.txt", "1560000035.52 color/1.png\n");
    write("aligned_depth.txt", "1560000035.53 aligned_depth/1.png\n");
    write("sensors.yaml", sensors("[ 41.0, 20.5, 42.0, 15.5 ]"));
    write("trans_matrix.yaml",
          "%YAML:1.0\ntrans_matrix:\n"
          "  - parent_frame: base_link\n    child_frame: laser\n"
          "    matrix: !!opencv-matrix\n      rows: 4\n      cols: 4\n      dt: d\n"
          "      data: [ 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 ]\n"
          "  - parent_frame: base_link\n    child_frame: d400_color_optical_frame\n"
          "    matrix: !!opencv-matrix\n      rows: 4\n      cols: 4\n      dt: d\n"
          "      data: [ 0, 0, 1, 0.2, -1, 0, 0, 0, 0, -1, 0, 1.1, 0, 0, 0, 1 ]\n");
    write("groundtruth.txt", "#Time px py pz qx qy qz qw\n1560000035.52 5 6 0 0 0 0 1\n");
  }
  static std::string sensors(const std::string& intrinsics) {
    return "%YAML:1.0\nd400_color_optical_frame:\n   sensor_type: camera\n   fps: 30\n"
           "   width: 40\n   height: 30\n   model: pinhole\n"
           "   intrinsics: !!opencv-matrix\n      rows: 1\n      cols: 4\n      dt: d\n"
           "      data: " +
           intrinsics +
           "\n   distortion_model: radial-tangential\n"
           "   distortion_coefficients: !!opencv-matrix\n      rows: 1\n      cols: 5\n"
           "      dt: d\n      data: [ 0.1, 0.2, 0.3, 0.4, 0.5 ]\n";
  }
};

TEST_F(OpenLorisFolder, IsReadWithTheOrderOfItsIntrinsicsAndTheRobotsTruth) {
  const auto sequence = open_sequence(folder_);
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_EQ(sequence->recording().source, "openloris");
  const auto camera = find_camera(sequence->recording());
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->fx_px, 41.0);
  EXPECT_EQ(camera->cx_px, 20.5);
  EXPECT_EQ(camera->fy_px, 42.0);
  EXPECT_EQ(camera->cy_px, 15.5);
  EXPECT_EQ(camera->k2, 0.2);
  EXPECT_EQ(camera->k3, 0.5);
  expect_frame(*sequence, 0, 50, 1.5F);
  const auto truth = sequence->groundtruth()->read();
  ASSERT_TRUE(truth) << truth.error().message;
  const SE3& T = truth->at(0).T_world_camera;
  EXPECT_TRUE(T.translation().isApprox(Eigen::Vector3d(5.2, 6, 1.1)));
  EXPECT_TRUE((T.rotation() * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX()));
}

TEST_F(OpenLorisFolder, WhatIsMissingIsNamed) {
  write("sensors.yaml", sensors("[ 41.0, 20.5 ]"));
  EXPECT_THAT(find_camera(open_sequence(folder_)->recording()).error().message,
              HasSubstr("sensors.yaml: has no d400_color_optical_frame with 'intrinsics'"));
  fs::remove(folder_ / "trans_matrix.yaml");
  EXPECT_THAT(open_sequence(folder_)->groundtruth()->read().error().message,
              HasSubstr("trans_matrix.yaml"));
  fs::rename(folder_ / "aligned_depth.txt", folder_ / "depth.txt");
  EXPECT_THAT(error_of(folder_, {.source = "openloris"}), HasSubstr("no aligned_depth.txt"));
}

class SevenScenesFolder : public LayoutTest {
 protected:
  SevenScenesFolder() {
    for (int i : {0, 1, 3}) {
      put_colour(fmt::format("frame-{:06}.color.png", i), 10 + i, 640, 480);
      put_depth(fmt::format("frame-{:06}.depth.png", i), i == 3 ? 65535 : 2000 + i, 640, 480);
      write(fmt::format("frame-{:06}.pose.txt", i), turned_matrix(i, 2, 3));
    }
  }
};

TEST_F(SevenScenesFolder, IsReadByNumber) {
  const auto sequence = open_sequence(folder_);
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_EQ(sequence->recording().source, "7scenes");
  ASSERT_EQ(sequence->size(), 3U);
  EXPECT_EQ(sequence->entry(2).stamp.ns, 100'000'000);  // frame 2 is missing
  expect_frame(*sequence, 1, 11, 2.001F);
  expect_frame(*sequence, 2, 13, 0.0F);
  const auto truth = sequence->groundtruth()->read();
  ASSERT_TRUE(truth) << truth.error().message;
  EXPECT_EQ(truth->at(2).stamp, sequence->entry(2).stamp);
  EXPECT_TRUE(
      (truth->at(2).T_world_camera * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(3, 3, 3)));
}

TEST_F(SevenScenesFolder, NoReadingStaysNoneHoweverFarTheCameraSees) {
  Camera far = find_camera(open_sequence(folder_)->recording()).value();
  far.max_depth_m = 100;
  EXPECT_EQ(open_sequence(folder_)->read(2, far)->depth_m(5, 5), 0.0F);
}

TEST_F(SevenScenesFolder, ADamagedPoseIsToldWithItsFile) {
  write("frame-000001.pose.txt", "1 2 3");
  EXPECT_THAT(open_sequence(folder_)->groundtruth()->read().error().message,
              HasSubstr("frame-000001.pose.txt: expected the 16 numbers of a matrix, found 3"));
  write("frame-000001.pose.txt", "2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1");
  EXPECT_THAT(open_sequence(folder_)->groundtruth()->read().error().message,
              HasSubstr("frame-000001.pose.txt: the matrix is no pose"));
}

class ScanNetFolder : public LayoutTest {
 protected:
  ScanNetFolder() {
    for (int i = 0; i < 12; i += 10) {
      put_colour(fmt::format("color/{}.jpg", i), 60 + i, 2 * kWidth + 1, 2 * kHeight + 1);
      put_depth(fmt::format("depth/{}.png", i), 1000 + i);
      write(fmt::format("pose/{}.txt", i), turned_matrix(i, 0, 0));
    }
    write("pose/0.txt", "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n0 0 0 1\n");
    write("intrinsic/intrinsic_color.txt", "81 0 40 0\n0 61 30 0\n0 0 1 0\n0 0 0 1\n");
    write("intrinsic/intrinsic_depth.txt", "40 0 19.5 0\n0 41 14.5 0\n0 0 1 0\n0 0 0 1\n");
  }
};

TEST_F(ScanNetFolder, ColourIsBroughtToTheSizeOfDepth) {
  const auto sequence = open_sequence(folder_);
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_EQ(sequence->recording().source, "scannet");
  ASSERT_EQ(sequence->size(), 2U);
  const Camera camera = find_camera(sequence->recording()).value();
  EXPECT_EQ(camera.width_px, kWidth);
  EXPECT_EQ(camera.fy_px, 41);
  expect_frame(*sequence, 1, 70, 1.01F);
}

TEST_F(ScanNetFolder, UnknownPosesAreLeftOut) {
  const auto truth = open_sequence(folder_)->groundtruth()->read();
  ASSERT_TRUE(truth) << truth.error().message;
  ASSERT_EQ(truth->size(), 1U);
  EXPECT_EQ(truth->at(0).stamp, open_sequence(folder_)->entry(1).stamp);
}

TEST_F(ScanNetFolder, IntrinsicsOfColourAreScaled) {
  fs::remove(folder_ / "intrinsic/intrinsic_depth.txt");
  const Camera camera = find_camera(open_sequence(folder_)->recording()).value();
  EXPECT_NEAR(camera.fx_px, 40, 1e-9);
  EXPECT_NEAR(camera.cx_px, 40.5 * 40 / 81 - 0.5, 1e-9);
}

class Open3dFolder : public LayoutTest {
 protected:
  Open3dFolder() {
    for (int i = 1; i <= 2; ++i) {
      put_colour(fmt::format("color/{:05}.jpg", i), 60 + i);
      put_depth(fmt::format("depth/{:05}.png", i), 1000 + i);
    }
    write("camera_intrinsic.json",
          R"({"width": 40, "height": 30, "intrinsic_matrix": [41, 0, 0, 0, 42, 0, 19, 14, 1]})");
    write("trajectory.log",
          "0 0 1\n" + turned_matrix(1, 2, 3) + "1 1 2\n" + turned_matrix(4, 5, 6));
  }
};

TEST_F(Open3dFolder, IsReadInMillimetresWithItsLog) {
  const auto sequence = open_sequence(folder_);
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_EQ(sequence->recording().source, "open3d");
  const auto camera = find_camera(sequence->recording());
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->fy_px, 42);
  EXPECT_EQ(camera->depth_scale, 1000);
  expect_frame(*sequence, 1, 62, 1.002F);
  const auto truth = sequence->groundtruth()->read();
  ASSERT_TRUE(truth) << truth.error().message;
  ASSERT_EQ(truth->size(), 2U);
  EXPECT_EQ(truth->at(1).stamp, sequence->entry(1).stamp);
  EXPECT_TRUE(truth->at(1).T_world_camera.translation().isApprox(Eigen::Vector3d(4, 5, 6)));
}

TEST_F(Open3dFolder, DamagedLogs) {
  const auto truth_error = [&](const std::string& text) {
    write("trajectory.log", text);
    const auto truth = open_sequence(folder_)->groundtruth()->read();
    return truth ? "no error" : truth.error().message;
  };
  const std::string one = "0 0 1\n" + turned_matrix(1, 2, 3);
  EXPECT_THAT(truth_error(one + "1 1 2\n0 -1 0 0\n"), HasSubstr("trajectory.log:7: the last pose"));
  EXPECT_THAT(truth_error(one + "2 2 3\n" + turned_matrix(0, 0, 0)), HasSubstr("below 2"));
  EXPECT_THAT(truth_error(one + one), HasSubstr("not later than the one before"));
  EXPECT_THAT(truth_error("x 0 1\n" + turned_matrix(0, 0, 0)), HasSubstr("'x' is not a number"));
  EXPECT_THAT(truth_error(""), HasSubstr("holds no pose"));
}

TEST_F(Open3dFolder, RedwoodsNamesAreTimesAndItsCameraNeedsNoFile) {
  fs::remove_all(folder_);
  put_colour("rgb/0000001-000000000000.jpg", 60, 640, 480);
  put_colour("rgb/0000002-000000033369.jpg", 62, 640, 480);
  put_depth("depth/0000001-000000000000.png", 1000, 640, 480);
  put_depth("depth/0000003-000000033369.png", 1003, 640, 480);
  write("trajectory.log", "0 0 1\n" + turned_matrix(1, 2, 3));
  const auto sequence = open_sequence(folder_);
  ASSERT_TRUE(sequence) << sequence.error().message;
  ASSERT_EQ(sequence->size(), 2U);
  EXPECT_EQ(sequence->entry(1).stamp.ns, 33'369'000);
  EXPECT_EQ(find_camera(sequence->recording())->fx_px, 525);
  expect_frame(*sequence, 1, 62, 1.003F);
}

class RealSenseFolder : public LayoutTest {
 protected:
  RealSenseFolder() {
    for (int i = 0; i < 3; ++i) {
      put_colour(fmt::format("rgb/{}.png", 1700000000000 + 33 * i), 60 + i);
      put_depth(fmt::format("aligned_depth/{}.png", 1700000000005 + 33 * i), 1000 + i);
    }
    write("intrinsics.json",
          R"({"width": 40, "height": 30, "fx": 41, "fy": 42, "ppx": 19, "ppy": 14,
              "model": "distortion.inverse_brown_conrady", "coeffs": [0, 0, 0, 0, 0]})");
  }
};

TEST_F(RealSenseFolder, IsReadInMillimetresAndPairedByTheTimesOfTheNames) {
  const auto sequence = open_sequence(folder_);
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_EQ(sequence->recording().source, "realsense");
  ASSERT_EQ(sequence->size(), 3U);
  EXPECT_EQ(sequence->entry(1).stamp.ns, 1'700'000'000'033'000'000);
  ASSERT_TRUE(sequence->pairing());
  EXPECT_NEAR(sequence->pairing()->depth_later_s, 0.005, 1e-9);
  expect_frame(*sequence, 1, 61, 1.001F);
  // Like every recording that is paired by time.
  EXPECT_NEAR(open_sequence(folder_, {.depth_offset = "-0.005"})->pairing()->depth_later_s, 0,
              1e-9);
}

TEST_F(RealSenseFolder, SecondsAndNumbersAreNamesToo) {
  fs::remove_all(folder_ / "rgb");
  fs::remove_all(folder_ / "aligned_depth");
  put_colour("color/1700000000.25.png", 60);
  put_depth("depth/1700000000.26.png", 1000);
  EXPECT_EQ(open_sequence(folder_)->entry(0).stamp.ns, 1'700'000'000'250'000'000);
  put_colour("color/7.png", 60);  // one that is no time: numbers count
  put_depth("depth/7.png", 1000);
  fs::remove(folder_ / "color/1700000000.25.png");
  fs::remove(folder_ / "depth/1700000000.26.png");
  EXPECT_EQ(open_sequence(folder_)->entry(0).stamp.ns, 233'333'333);
}

TEST_F(RealSenseFolder, WhatIsMissingIsNamed) {
  write("intrinsics.json", R"({"width": 40, "height": 30, "ppx": 19})");
  EXPECT_THAT(find_camera(open_sequence(folder_)->recording()).error().message,
              HasSubstr("intrinsics.json: 'fx' is missing"));
  fs::remove_all(folder_ / "aligned_depth");
  EXPECT_THAT(error_of(folder_, {.source = "realsense"}), HasSubstr("has no folder of depth"));
  fs::create_directory(folder_ / "depth");
  EXPECT_THAT(error_of(folder_), HasSubstr("depth: holds no picture named 'NUMBER.png'"));
  put_depth("depth/7.png", 1000);
  fs::remove_all(folder_ / "rgb");
  put_colour("rgb/8.png", 60);
  EXPECT_THAT(error_of(folder_), HasSubstr("no colour picture has the number of a depth picture"));
  put_colour("rgb/08.png", 60);
  EXPECT_THAT(error_of(folder_), HasSubstr("is the same frame as"));
}

TEST_F(RealSenseFolder, ADepthScaleThatIsNotTheFormatsIsTheUsersWord) {
  const auto recording = open_recording(folder_);
  EXPECT_EQ(recording->depth_scale, 1000);
  write("camera.yaml", "{width: 40, height: 30, fx: 41, fy: 42, cx: 19, cy: 14, depth_scale: 500}");
  EXPECT_EQ(find_camera(*recording)->depth_scale, 500);
}

TEST_F(LayoutTest, ASourceCanBeNamedAndOneThatIsNoneListsThem) {
  put_colour("rgb/1.png", 60, 640, 480);
  put_depth("depth/1.png", 1000, 640, 480);
  EXPECT_THAT(error_of(folder_), HasSubstr("has no rgb.txt, and is no recording that is known"));
  EXPECT_EQ(error_of(folder_, {.source = "open3d"}), "no error");
  EXPECT_THAT(error_of(folder_, {.source = "oni"}),
              HasSubstr("'oni' is no source; known are 7scenes, bag, icl, open3d, openloris"));
  EXPECT_THAT(error_of(folder_ / "rgb/1.png"), HasSubstr("1.png: is no recording that is known"));
  for (const std::string& name : source_names()) {
    EXPECT_THAT(source_table(), HasSubstr("  " + name + " "));
  }
}

}  // namespace
}  // namespace ydd::sources
