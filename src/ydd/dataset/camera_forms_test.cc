// SPDX-License-Identifier: Apache-2.0
// Camera files as other programs write them, in miniature.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/dataset/camera_file.h"

namespace ydd {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Result<Camera> load(const std::string& text) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_file_atomically(folder / "c.yaml", text));
  return load_camera(folder / "c.yaml");
}
std::string error_of(const std::string& text) {
  const auto camera = load(text);
  return camera ? "no error" : camera.error().message;
}
void expect_lens(const Result<Camera>& camera, double k2, double depth_scale) {
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->width_px, 320);
  EXPECT_EQ(camera->height_px, 240);
  EXPECT_EQ(camera->fx_px, 267.7);
  EXPECT_EQ(camera->fy_px, 269.6);
  EXPECT_EQ(camera->cx_px, 160.5);
  EXPECT_EQ(camera->cy_px, 123.25);
  EXPECT_EQ(camera->k2, k2);
  EXPECT_EQ(camera->depth_scale, depth_scale);
}

const std::string kOrbSlam =
    "%YAML:1.0\n"
    "Camera.fx: 267.7\nCamera.fy: 269.6\nCamera.cx: 160.5\nCamera.cy: 123.25\n"
    "Camera.k2: 0.25\nCamera.width: 320\nCamera.height: 240\nCamera.bf: 40.155\n"
    "Viewer.PointSize:2\nDepthMapFactor: 5000.0\n";
const std::string kStella =
    "Camera:\n  model: \"perspective\"\n  setup: RGBD\n"
    "  fx: 267.7\n  fy: 269.6\n  cx: 160.5\n  cy: 123.25\n  k2: 0.25\n  cols: 320\n  rows: 240\n";
const std::string kRos =
    "image_width: 320\nimage_height: 240\ncamera_name: rgb\n"
    "camera_matrix:\n  rows: 3\n  cols: 3\n"
    "  data: [267.7, 0.0, 160.5, 0.0, 269.6, 123.25, 0, 0, 1]\n"
    "distortion_model: plumb_bob\n"
    "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.0, 0.25, 0.0, 0.0, 0.0]\n";
const std::string kKalibr =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [267.7, 269.6, 160.5, 123.25]\n"
    "  distortion_model: radtan\n  distortion_coeffs: [0.0, 0.25, 0.0, 0.0]\n"
    "  resolution: [320, 240]\n  rostopic: /rgb\n";
const std::string kRealSense =
    R"({"width": 320, "height": 240, "fx": 267.7, "fy": 269.6, "ppx": 160.5, "ppy": 123.25,)"
    R"( "model": "distortion.inverse_brown_conrady", "coeffs": [0, 0, 0, 0, 0])";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(CameraForms, SettingsOfOrbSlam) {
  const auto camera = load(kOrbSlam);
  expect_lens(camera, 0.25, 5000);
  EXPECT_NEAR(camera->baseline_m, 0.15, 1e-12);
  // A whole number may be written as a real one.
  expect_lens(load(with(kOrbSlam, "width: 320", "width: 320.0")), 0.25, 5000);
}

TEST(CameraForms, SettingsOfStellaVslamNestedAndFlat) {
  expect_lens(load(kStella + "Preprocessing:\n  depthmap_factor: 5000.0\n"), 0.25, 5000);
  expect_lens(load(kStella + "depthmap_factor: 1000\n"), 0.25, 1000);
  expect_lens(load("Camera.fx: 267.7\nCamera.fy: 269.6\nCamera.cx: 160.5\nCamera.cy: 123.25\n"
                   "Camera.k2: 0.25\nCamera.cols: 320\nCamera.rows: 240\n"
                   "Camera.focal_x_baseline: 40\ndepthmap_factor: 5000\n"),
              0.25, 5000);
  EXPECT_THAT(error_of(kStella), HasSubstr("'Preprocessing.depthmap_factor' is missing"));
}

TEST(CameraForms, CalibrationsNeedTheScaleOfDepth) {
  const std::string scale = "depth_scale: 1000\n";
  expect_lens(load(kRos + scale), 0.25, 1000);
  expect_lens(load(kKalibr + scale), 0.25, 1000);
  expect_lens(load(kRealSense + R"(, "depth_scale": 1000})"), 0, 1000);
  for (const std::string& text : {kRos, kKalibr, kRealSense + "}"}) {
    EXPECT_THAT(error_of(text), HasSubstr("'depth_scale' is missing"));
  }
  EXPECT_THAT(error_of(kRos + "depth_scale: 0.001\n"),
              AllOf(HasSubstr("'depth_scale' is '0.001'"), HasSubstr("1000: millimetres")));
}

TEST(CameraForms, MatricesOfOpenCvRosAndOpen3d) {
  expect_lens(load("%YAML:1.0\n---\nimage_width: 320\nimage_height: 240\n"
                   "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                   "   data: [ 267.7, 0., 160.5, 0., 269.6, 123.25, 0., 0., 1. ]\n"
                   "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 8\n   dt: d\n"
                   "   data: [ 0., 0.25, 0., 0., 0., 0., 0., 0. ]\ndepth_scale: 1000\n"),
              0.25, 1000);
  expect_lens(load("header:\n  frame_id: rgb\nheight: 240\nwidth: 320\n"
                   "distortion_model: plumb_bob\nd:\n- 0.0\n- 0.25\n- 0.0\n- 0.0\n- 0.0\n"
                   "k: [267.7, 0.0, 160.5, 0.0, 269.6, 123.25, 0.0, 0.0, 1.0]\n"
                   "depth_scale: 1000\n---\n"),
              0.25, 1000);
  expect_lens(load(R"({"width": 320, "height": 240, "depth_scale": 1000, "intrinsic_matrix":)"
                   R"( [267.7, 0, 0, 0, 269.6, 0, 160.5, 123.25, 1]})"),
              0, 1000);
  EXPECT_THAT(error_of("width: 320\nheight: 240\ndepth_scale: 1000\nK: [1, 2, 3]\n"),
              HasSubstr("c.yaml:4: 'K' must be the nine numbers"));
  EXPECT_THAT(error_of("width: 320\nheight: 240\ndepth_scale: 1000\n"
                       "K: [267.7, 1.5, 160, 0, 269, 123, 0, 0, 1]\n"),
              HasSubstr("'K' must be the nine numbers"));
}

TEST(CameraForms, CamodocalAndNiceSlam) {
  expect_lens(load("%YAML:1.0\n---\nmodel_type: PINHOLE\ncamera_name: c\nimage_width: 320\n"
                   "image_height: 240\ndistortion_parameters:\n   k1: 0\n   k2: 0.25\n"
                   "projection_parameters:\n   fx: 267.7\n   fy: 269.6\n   cx: 160.5\n"
                   "   cy: 123.25\ndepth_scale: 1000\n"),
              0.25, 1000);
  expect_lens(load("cam:\n  H: 240\n  W: 320\n  fx: 267.7\n  fy: 269.6\n  cx: 160.5\n"
                   "  cy: 123.25\n  png_depth_scale: 6553.5\n"),
              0, 6553.5);
}

TEST(CameraForms, OtherLensesAreRefusedByName) {
  const auto refused = [](const std::string& text, const char* name) {
    EXPECT_THAT(error_of(text), AllOf(HasSubstr(name), HasSubstr("another lens"))) << text;
  };
  refused(kOrbSlam + "Camera.type: \"KannalaBrandt8\"\n", "c.yaml:12: 'Camera.type'");
  refused(with(kStella, "perspective", "fisheye"), "'fisheye'");
  refused(with(kStella, "perspective", "equirectangular"), "'equirectangular'");
  refused(with(kRos, "plumb_bob", "equidistant"), "c.yaml:8: 'distortion_model' is 'equidistant'");
  refused(with(kKalibr, "radtan", "equi"), "'equi'");
  refused(with(kKalibr, "pinhole", "omni"), "'omni'");
  refused(with(kRealSense, "inverse_brown_conrady", "kannala_brandt4") + "}", "kannala_brandt4");
  refused(with(kRealSense, "0, 0, 0, 0, 0", "0.1, 0, 0, 0, 0") + "}", "inverse_brown_conrady");
  refused("model: fisheye\nwidth: 320\nheight: 240\nfx: 260\nfy: 261\ncx: 160\ncy: 120\n",
          "'model' is 'fisheye'");
}

TEST(CameraForms, RationalLensesAreRefusedUnlessTheirTermsAreZero) {
  const std::string own = "width: 320\nheight: 240\nfx: 260\nfy: 261\ncx: 160\ncy: 120\n";
  EXPECT_THAT(error_of(kOrbSlam + "Camera.k4: 2.5\n"),
              HasSubstr("c.yaml:12: 'Camera.k4' is '2.5'"));
  EXPECT_THAT(error_of(own + "k6: 0.5\n"), HasSubstr("c.yaml:7: 'k6' is '0.5' but can only be 0"));
  EXPECT_THAT(error_of(with(kStella, "k2", "k5")), HasSubstr("'Camera.k5' is '0.25'"));
  EXPECT_THAT(error_of(with(kRos, "0.0, 0.25, 0.0, 0.0, 0.0", "0, 0, 0, 0, 0, 0, -1.5, 0") +
                       "depth_scale: 1000\n"),
              HasSubstr("of which the 7th is '-1.5'"));
  expect_lens(load(kOrbSlam + "Camera.k4: 0.0\nCamera.k5: 0\nCamera.k6: -0.0\n"), 0.25, 5000);
  EXPECT_EQ(error_of(own + "k4: 0\nmodel: pinhole\n"), "no error");
}

TEST(CameraForms, KeysThatContradictAreNamedWithBothLines) {
  EXPECT_THAT(error_of(with(kOrbSlam, "Camera.fy", "Camera.fx: 400\nCamera.fy")),
              HasSubstr("c.yaml:3: 'Camera.fx' is '400' here and '267.7' in line 2"));
  expect_lens(load(kOrbSlam + "Camera.fx: 267.70\nCamera.bf: 40.155\n"), 0.25, 5000);
  // The slip of the pen behind it comes first.
  EXPECT_THAT(error_of(with(kOrbSlam, "Camera.fx", "Camera.fy")),
              HasSubstr("'Camera.fx' is missing; an RGB-D camera in a settings file of ORB-SLAM"));
}

TEST(CameraForms, ValuesThatNoCameraHas) {
  EXPECT_THAT(error_of(with(kOrbSlam, "cy: 123.25", "cy: 539.2")),
              HasSubstr("the principal point (160.5, 539.2) lies outside of the picture"));
  EXPECT_THAT(error_of(with(kOrbSlam, "cx: 160.5", "cx: -3")), HasSubstr("principal point"));
  EXPECT_THAT(error_of(with(kOrbSlam, "fy: 269.6", "fy: 2696")), HasSubstr("a factor of two"));
  EXPECT_THAT(error_of(with(with(kOrbSlam, "fx: 267.7", "fx: 1.5"), "fy: 269.6", "fy: 1.5")),
              HasSubstr("an opening of 178.9 degrees"));
  EXPECT_THAT(error_of(with(with(kOrbSlam, "fx: 267.7", "fx: 26770"), "fy: 269.6", "fy: 26960")),
              HasSubstr("an opening of 0.7 degrees"));
  EXPECT_THAT(error_of(with(kOrbSlam, "fx: 267.7", "fx: nan")), HasSubstr("c.yaml:2: 'Camera.fx'"));
}

TEST(CameraForms, UnknownFormsNameTheKnownOnes) {
  EXPECT_THAT(error_of("lens: {focal: 3}\n"),
              AllOf(HasSubstr("not a form of camera file that is known"), HasSubstr("ORB-SLAM3"),
                    HasSubstr("camera_info"), Not(HasSubstr("\n"))));
  EXPECT_THAT(error_of(kKalibr + with(kKalibr, "cam0", "cam1")),
              HasSubstr("holds the cameras cam0, cam1; keep the one of the colour pictures"));
}

}  // namespace
}  // namespace ydd
