// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/camera_file.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/dataset/camera_presets.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class CameraFileTest : public testing::Test {
 protected:
  CameraFileTest()
      : folder_(fs::path(testing::TempDir()) /
                testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~CameraFileTest() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  std::string load_error(const std::string& text) const {
    const auto camera = load_camera(write("camera.yaml", text));
    return camera ? "no error" : camera.error().message;
  }

  fs::path folder_;
};

std::string as_yaml(Camera camera) {
  OptionTable table;
  camera.describe(table);
  return table.to_yaml();
}

constexpr const char* kMinimal = "width: 320\nheight: 240\nfx: 260\nfy: 261\ncx: 160\ncy: 120\n";

TEST_F(CameraFileTest, PresetsEqualTheYamlFiles) {
  for (const Camera& preset : camera_presets()) {
    const auto file = fs::path(YDD_SOURCE_DIR) / "configs/camera" / (preset.name + ".yaml");
    const auto camera = load_camera(file);
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_EQ(as_yaml(*camera), as_yaml(preset));
  }
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(YDD_SOURCE_DIR) / "configs/camera")) {
    files += entry.path().extension() == ".yaml" ? 1 : 0;
  }
  EXPECT_EQ(files, camera_presets().size());
}

TEST_F(CameraFileTest, OwnFormatKeepsDefaultsOfWhatIsLeftOut) {
  const auto camera = load_camera(write("lab.yaml", kMinimal));
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->name, "lab");
  EXPECT_EQ(camera->width_px, 320);
  EXPECT_EQ(camera->fy_px, 261.0);
  EXPECT_EQ(camera->depth_scale, Camera().depth_scale);
  EXPECT_FALSE(camera->has_distortion());
}

TEST_F(CameraFileTest, BadValuesNameFileAndLine) {
  EXPECT_THAT(load_error(std::string(kMinimal) + "fz: 3\n"),
              AllOf(HasSubstr("camera.yaml:7: unknown key 'fz'"), Not(HasSubstr("\n"))));
  EXPECT_THAT(load_error(std::string(kMinimal) + "k1: wide\n"),
              HasSubstr("camera.yaml:7: 'k1' is 'wide' but must be a number"));
  EXPECT_THAT(load_error(std::string(kMinimal) + "fps: 0\n"),
              HasSubstr("camera.yaml:7: 'fps' is '0' but must be a number in [0.1, 1000]"));
  EXPECT_THAT(load_error(std::string(kMinimal) + "fps: [1, 2]\n"),
              HasSubstr("camera.yaml:7: 'fps' must be a single value"));
  EXPECT_THAT(load_error("width: 320\nheight: 240\nfx: 1\n"),
              HasSubstr("camera.yaml: 'fy' is missing"));
  EXPECT_THAT(load_error(std::string(kMinimal) + "min_depth: 5\nmax_depth: 4\n"),
              HasSubstr("min_depth 5 m must be less than max_depth 4 m"));
  EXPECT_THAT(load_error("fx: [1\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(load_error(""), HasSubstr("must hold 'key: value' lines"));
  EXPECT_THAT(load_camera(folder_ / "none.yaml").error().message,
              HasSubstr("none.yaml: cannot be opened"));
}

TEST_F(CameraFileTest, OrbSlamOldSettings) {
  const auto camera = load_camera(write("TUM1.yaml", R"(%YAML:1.0

# Camera Parameters
Camera.type: "PinHole"
Camera.fx: 517.306408
Camera.fy: 516.469215
Camera.cx: 318.643040
Camera.cy: 255.313989
Camera.k1: 0.262383
Camera.k2: -0.953104
Camera.p1: -0.005358
Camera.p2: 0.002628
Camera.k3: 1.163314
Camera.width: 640
Camera.height: 480
Camera.fps: 30.0
Camera.bf: 40.0
Camera.RGB: 1
ThDepth: 40.0
DepthMapFactor: 5000.0
ORBextractor.nFeatures: 1000
Tbc: !!opencv-matrix
   rows: 1
   cols: 1
   dt: f
   data: [1.0]
)"));
  ASSERT_TRUE(camera) << camera.error().message;
  Camera expected = *camera_preset("tum_fr1");
  expected.name = "TUM1";
  expected.baseline_m = 40.0 / 517.306408;
  EXPECT_EQ(as_yaml(*camera), as_yaml(expected));
}

constexpr const char* kNewSettings = R"(%YAML:1.0
---
File.version: "1.0"
Camera.type: "PinHole"
Camera1.fx: 535.4
Camera1.fy: 539.2
Camera1.cx: 320.1
Camera1.cy: 247.6
Camera.width: 640
Camera.height: 480
Camera.fps: 15
Stereo.ThDepth: 40.0
Stereo.b: 0.07471
)";

TEST_F(CameraFileTest, OrbSlamNewSettings) {
  const auto camera =
      load_camera(write("rs.yaml", std::string(kNewSettings) + "RGBD.DepthMapFactor: 1000.0\n"));
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->fx_px, 535.4);
  EXPECT_EQ(camera->cy_px, 247.6);
  EXPECT_EQ(camera->fps, 15.0);
  EXPECT_EQ(camera->depth_scale, 1000.0);
  EXPECT_EQ(camera->baseline_m, 0.07471);
}

TEST_F(CameraFileTest, OrbSlamSettingsThatDoNotFit) {
  EXPECT_THAT(load_error(kNewSettings), HasSubstr("'RGBD.DepthMapFactor' is missing"));
  std::string fisheye = std::string(kNewSettings) + "RGBD.DepthMapFactor: 1000.0\n";
  fisheye.replace(fisheye.find("PinHole"), 7, "KannalaBrandt8");
  EXPECT_THAT(load_error(fisheye),
              HasSubstr("camera.yaml:4: 'Camera.type' is 'KannalaBrandt8', another lens"));
  EXPECT_THAT(load_error(std::string(kNewSettings) + "RGBD.DepthMapFactor: 0\n"),
              HasSubstr("camera.yaml:14: 'RGBD.DepthMapFactor' is '0'"));
}

TEST_F(CameraFileTest, FolderNamesTellThePreset) {
  const auto name_of = [](std::string_view folder) {
    const auto camera = camera_preset_of_folder(folder);
    return camera ? camera->name : "";
  };
  EXPECT_EQ(name_of("rgbd_dataset_freiburg1_xyz"), "tum_fr1");
  EXPECT_EQ(name_of("tum_fr2_desk"), "tum_fr2");
  EXPECT_EQ(name_of("FR3_walking_halfsphere"), "tum_fr3");
  EXPECT_EQ(name_of("rgbd_dataset_freiburg3_long_office_household"), "tum_fr3");
  EXPECT_EQ(name_of("rgbd_bonn_crowd2"), "bonn");
  EXPECT_EQ(name_of("crowd_xyz"), "office");
  EXPECT_EQ(name_of("office_room_loop"), "office");
  EXPECT_EQ(name_of("office_room_traj0_frei_png"), "");  // ICL-NUIM: another camera
  EXPECT_EQ(name_of("kitchen"), "");
}

TEST_F(CameraFileTest, FindGoesFromExplicitOverOwnFileToFolderName) {
  const fs::path named = folder_ / "fr1_xyz";
  fs::create_directories(named);
  EXPECT_EQ(find_camera(named)->name, "tum_fr1");
  EXPECT_EQ(find_camera(named.string() + "/")->name, "tum_fr1");
  write("fr1_xyz/camera.yaml", std::string(kMinimal) + "name: own\n");
  EXPECT_EQ(find_camera(named)->name, "own");
  EXPECT_EQ(find_camera(named, "tum_fr3")->name, "tum_fr3");
  EXPECT_EQ(find_camera(named, write("given.yaml", kMinimal).string())->name, "given");
}

TEST_F(CameraFileTest, FindSaysWhichPresetsThereAre) {
  const fs::path unknown = folder_ / "kitchen";
  fs::create_directories(unknown);
  EXPECT_THAT(find_camera(unknown).error().message,
              AllOf(HasSubstr("kitchen: which camera?"), HasSubstr("tum_fr1, tum_fr2, tum_fr3")));
  EXPECT_THAT(find_camera(unknown, "nikon").error().message,
              AllOf(HasSubstr("nikon: no such camera file"), HasSubstr("bonn, office")));
}

}  // namespace
}  // namespace ydd
