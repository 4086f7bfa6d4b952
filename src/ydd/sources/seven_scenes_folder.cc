// SPDX-License-Identifier: Apache-2.0
//
// 7-Scenes (Microsoft; https://www.microsoft.com/en-us/research/project/rgb-d-dataset-7-scenes):
// frame-000000.color.png, .depth.png in millimetres with 65535 for no reading, .pose.txt with
// T_world_camera. No stamps. The colour and the depth camera of the Kinect are as they are, not
// registered; the intrinsics that the dataset gives are those of depth, for both.
#include <utility>

#include <fmt/format.h>

#include "ydd/base/log.h"
#include "ydd/dataset/picture_files.h"
#include "ydd/sources/frame_numbers.h"
#include "ydd/sources/layout.h"
#include "ydd/sources/pose_files.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "frame-";

bool looks_like_seven_scenes(const fs::path& path) {
  return has(path, "frame-000000.color.png") && has(path, "frame-000000.depth.png");
}

Camera seven_scenes_camera() {
  Camera camera{.name = "seven_scenes", .fx_px = 585, .fy_px = 585};
  camera.cx_px = 320, camera.cy_px = 240;
  camera.depth_scale = 1000;
  return camera;
}

Result<Recording> open_seven_scenes(const fs::path& folder, const SequenceOptions&) {
  const auto colour = numbered_files(folder, kPrefix, {".color.png"});
  if (!colour) return colour.error();
  const auto depth = numbered_files(folder, kPrefix, {".depth.png"});
  if (!depth) return depth.error();
  Result<Recording> recording = recording_of(folder, *colour, *depth);
  if (!recording) return recording;
  recording->pictures = picture_files(*recording, {.no_reading_from = 65535});
  recording->camera = seven_scenes_camera();
  recording->depth_scale = seven_scenes_camera().depth_scale;
  std::vector<std::pair<Timestamp, fs::path>> poses;
  for (const NumberedFile& file : *colour) {
    std::string name = file.file.filename().string();
    name.replace(name.find(".color.png"), std::string::npos, ".pose.txt");
    poses.emplace_back(frame_stamp(file.number), folder / name);
  }
  if (fs::exists(poses.front().second)) {
    recording->groundtruth = truth_of_files(folder, std::move(poses));
  }
  return recording;
}

}  // namespace

Layout seven_scenes_layout() {
  return {"7scenes", "folder with frame-000000.color.png, .depth.png and .pose.txt: 7-Scenes",
          looks_like_seven_scenes, open_seven_scenes};
}

}  // namespace ydd::sources
