// SPDX-License-Identifier: Apache-2.0
//
// A folder of colour pictures beside one of depth pictures in millimetres, named by number or time,
// and a file with the intrinsics: what Open3D's recorders, the Redwood recordings and scripts for
// RealSense cameras leave. Open3D (https://www.open3d.org/docs, sensors/realsense):
// color/000000.jpg, depth/000000.png, camera_intrinsic.json; Redwood (http://redwood-data.org):
// rgb/ or image/ and depth/ with "0000001-000000033369.png", trajectory.log, a PrimeSense camera
// without a file.
#include <array>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/log.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/dataset/picture_files.h"
#include "ydd/sources/frame_numbers.h"
#include "ydd/sources/layout.h"
#include "ydd/sources/pose_files.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

constexpr double kMillimetres = 1000;  // counts of a metre
constexpr std::array kColourFolders = {"color", "colour", "rgb", "image", "images"};
constexpr std::array kDepthFolders = {"aligned_depth", "depth_aligned", "depth"};
constexpr std::array kOpen3dFiles = {"camera_intrinsic.json", "camera_primesense.json"};
constexpr std::array kCameraFiles = {"intrinsics.json", "intrinsic.json", "camera_intrinsics.json",
                                     "camera.json", "color_intrinsics.json"};

template <std::size_t N>
std::optional<fs::path> first_there(const fs::path& folder,
                                    const std::array<const char*, N>& names) {
  for (const char* const name : names) {
    if (has(folder, name)) return folder / name;
  }
  return std::nullopt;
}

bool has_both(const fs::path& folder) {
  return first_there(folder, kColourFolders) && first_there(folder, kDepthFolders);
}

bool looks_like_open3d(const fs::path& path) {
  return has_both(path) && (first_there(path, kOpen3dFiles) || has(path, "trajectory.log"));
}

bool looks_like_realsense(const fs::path& path) {
  return has_both(path) && (first_there(path, kCameraFiles) || has(path, "camera.yaml"));
}

Result<Recording> open_picture_folders(const fs::path& folder) {
  const auto colour_folder = first_there(folder, kColourFolders);
  const auto depth_folder = first_there(folder, kDepthFolders);
  if (!colour_folder || !depth_folder) {
    return Error{
        fmt::format("{}: has no folder {} (color, colour, rgb and image; aligned_depth and "
                    "depth are looked for)",
                    folder.string(), colour_folder ? "of depth" : "of colour pictures")};
  }
  const auto colour = numbered_files(*colour_folder, "", {".jpg", ".png", ".jpeg"});
  if (!colour) return colour.error();
  const auto depth = numbered_files(*depth_folder, "", {".png"});
  if (!depth) return depth.error();
  Result<Recording> recording = recording_of(folder, *colour, *depth);
  if (!recording) return recording;
  recording->pictures = picture_files(*recording);
  recording->depth_scale = kMillimetres;
  return recording;
}

/// Of the sensor that Redwood was recorded with, as Open3D has it.
Camera primesense() {
  Camera camera{.name = "primesense", .fx_px = 525, .fy_px = 525, .cx_px = 319.5, .cy_px = 239.5};
  camera.depth_scale = kMillimetres;
  return camera;
}

Result<Recording> open_open3d(const fs::path& folder, const SequenceOptions&) {
  Result<Recording> recording = open_picture_folders(folder);
  if (!recording) return recording;
  if (const auto file = first_there(folder, kOpen3dFiles)) {
    recording->camera = load_camera(*file, kMillimetres);
  } else {
    log::info("{}: has no camera_intrinsic.json; taken for a PrimeSense of 525 px",
              folder.string());
    recording->camera = primesense();
  }
  if (has(folder, "trajectory.log")) {
    std::vector<Timestamp> stamps;
    for (const PictureEntry& picture : recording->colour) stamps.push_back(picture.stamp);
    recording->groundtruth = truth_of_log(folder / "trajectory.log", std::move(stamps));
  }
  return recording;
}

Result<Recording> open_realsense(const fs::path& folder, const SequenceOptions&) {
  Result<Recording> recording = open_picture_folders(folder);
  if (!recording) return recording;
  if (const auto file = first_there(folder, kCameraFiles)) {
    recording->camera = load_camera(*file, kMillimetres);
  }
  return recording;
}

}  // namespace

Layout open3d_layout() {
  return {"open3d",
          "folder with color/, depth/ and camera_intrinsic.json or trajectory.log: Open3D, Redwood",
          looks_like_open3d, open_open3d};
}

Layout realsense_layout() {
  return {"realsense", "folder with color/, depth/ and intrinsics.json or camera.yaml: RealSense",
          looks_like_realsense, open_realsense};
}

}  // namespace ydd::sources
