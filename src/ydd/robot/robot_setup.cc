// SPDX-License-Identifier: Apache-2.0
#include "ydd/robot/robot_setup.h"

#include <cstdlib>
#include <filesystem>

#include "ydd/dataset/camera_file.h"
#include "ydd/detection/detector_config.h"
#include "ydd/messages/ros_pictures.h"

namespace ydd {
namespace {

constexpr const char* kBlind = "none";

/// What a node without the parameter means: YDD_DETECTOR, else the network that comes with the
/// program, from where it was built (CLONE/build/ros1/ydd_slam) or installed
/// (PREFIX/lib/ydd-slam/ros1/ ydd_slam).
Result<std::string> robot_detector() {
  namespace fs = std::filesystem;
  const char* const named = std::getenv("YDD_DETECTOR");
  if (named != nullptr && *named != '\0') return std::string(named);
  std::error_code failure;
  const fs::path here = fs::read_symlink("/proc/self/exe", failure).parent_path();
  const fs::path file = fs::path("configs") / "detector" / "ydd.yaml";
  for (const fs::path& place :
       {here / "../../../../share/ydd-slam" / file, here / "../../.." / file}) {
    if (fs::is_regular_file(place, failure)) return place.lexically_normal().string();
  }
  return Error{
      "there is no detector file near the program: name one in the parameter detector (or none)"};
}

}  // namespace

Result<RobotSetup> robot_setup(const RobotOptions& options, const CameraInfoMessage& calibration,
                               const SE3& T_map_world) {
  const bool told = options.camera.empty();
  Result<Camera> camera = told ? camera_of(calibration, false) : find_camera("", options.camera);
  if (!camera) return told ? Error{"camera_info: " + camera.error().message} : camera.error();
  Result<ObjectCatalogue> catalogue = options.objects.empty()
                                          ? Result(ObjectCatalogue::defaults())
                                          : ObjectCatalogue::load(options.objects);
  if (!catalogue) return catalogue.error();
  Result<MapKey> key = MapKey::find(options.map_key_file);
  if (!key) return key.error();
  RobotSetup setup{*camera,     options.system,    *catalogue,     {},
                   T_map_world, options.save_file, *std::move(key)};
  // A robot's camera waits for nobody.
  if (setup.options.detect.mode == DetectMode::automatic && !setup.options.deterministic) {
    setup.options.detect.mode = DetectMode::asynchronous;
  }
  if (options.system.dynamics.variant == Variant::off || options.detector == kBlind) return setup;
  const Result<std::string> file =
      options.detector.empty() ? robot_detector() : Result(options.detector);
  if (!file) return file.error();
  if (*file == kBlind) return setup;
  setup.make_detector = [file = *file, objects = *catalogue] {
    return make_detector(file, {}, objects);
  };
  return setup;
}

}  // namespace ydd
