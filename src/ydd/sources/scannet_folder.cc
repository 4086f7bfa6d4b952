// SPDX-License-Identifier: Apache-2.0
//
// What ScanNet's reader exports of a .sens file (https://github.com/ScanNet/ScanNet, SensReader):
// color/12.jpg (1296 x 968), depth/12.png (640 x 480, millimetres), pose/12.txt (T_world_camera,
// infinite where it is unknown), intrinsic/intrinsic_depth.txt and intrinsic_color.txt (4 x 4).
// Depth is registered to colour but smaller: colour is brought to its size, as everybody does.
#include <utility>

#include <fmt/format.h>

#include "ydd/dataset/picture_files.h"
#include "ydd/sources/frame_numbers.h"
#include "ydd/sources/layout.h"
#include "ydd/sources/pose_files.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

bool looks_like_scannet(const fs::path& path) {
  return has(path, "color") && has(path, "depth") &&
         (has(path, "intrinsic") || has(path, "intrinsics_depth.txt") ||
          has(path, "intrinsics_color.txt"));
}

/// The first of the two names that is there; the last, which is missing too, for the error.
fs::path intrinsics_file(const fs::path& folder, const std::string& which) {
  const fs::path own = folder / "intrinsic" / ("intrinsic_" + which + ".txt");
  const fs::path frames = folder / ("intrinsics_" + which + ".txt");
  return fs::exists(frames) ? frames : own;
}

struct Size {
  int width_px = 0, height_px = 0;
};

Result<Camera> scannet_camera(const fs::path& folder, Size colour, Size depth) {
  Camera camera{.name = "scannet", .width_px = depth.width_px, .height_px = depth.height_px};
  camera.depth_scale = 1000;
  const fs::path depth_file = intrinsics_file(folder, "depth");
  const bool own = fs::exists(depth_file);
  const Result<Eigen::Matrix4d> K =
      read_matrix_file(own ? depth_file : intrinsics_file(folder, "color"));
  if (!K) return K.error();
  // Those of colour hold for its size.
  const double sx = own ? 1.0 : static_cast<double>(depth.width_px) / colour.width_px;
  const double sy = own ? 1.0 : static_cast<double>(depth.height_px) / colour.height_px;
  camera.fx_px = sx * (*K)(0, 0), camera.fy_px = sy * (*K)(1, 1);
  camera.cx_px = sx * ((*K)(0, 2) + 0.5) - 0.5, camera.cy_px = sy * ((*K)(1, 2) + 0.5) - 0.5;
  if (auto r = check_camera(camera); !r) {
    return Error{fmt::format("{}: {}", depth_file.string(), r.error().message)};
  }
  return camera;
}

Result<Recording> open_scannet(const fs::path& folder, const SequenceOptions&) {
  const auto colour = numbered_files(folder / "color", "", {".jpg", ".png"});
  if (!colour) return colour.error();
  const auto depth = numbered_files(folder / "depth", "", {".png"});
  if (!depth) return depth.error();
  Result<Recording> recording = recording_of(folder, *colour, *depth);
  if (!recording) return recording;
  const auto store = picture_files(*recording);
  const Result<ColourPicture> c = store->colour(0);
  if (!c) return c.error();
  const Result<DepthPicture> d = store->depth(0);
  if (!d) return d.error();
  recording->pictures =
      picture_files(*recording, {.colour_size_px = std::pair(d->width_px, d->height_px)});
  recording->camera =
      scannet_camera(folder, {c->width_px, c->height_px}, {d->width_px, d->height_px});
  recording->depth_scale = 1000;
  std::vector<std::pair<Timestamp, fs::path>> poses;
  for (std::size_t i = 0; i < colour->size(); ++i) {
    const std::string stem = (*colour)[i].file.stem().string();
    poses.emplace_back(recording->colour[i].stamp, folder / "pose" / (stem + ".txt"));
  }
  if (has(folder, "pose")) {
    recording->groundtruth = truth_of_files(folder / "pose", std::move(poses));
  }
  return recording;
}

}  // namespace

Layout scannet_layout() {
  return {"scannet", "folder with color/, depth/, pose/ and intrinsic/: exports of ScanNet",
          looks_like_scannet, open_scannet};
}

}  // namespace ydd::sources
