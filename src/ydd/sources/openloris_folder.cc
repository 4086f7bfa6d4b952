// SPDX-License-Identifier: Apache-2.0
//
// OpenLORIS-Scene (https://lifelong-robotic-vision.github.io/dataset/scene), the camera d400: lists
// color.txt and aligned_depth.txt, depth in millimetres, sensors.yaml with intrinsics in the order
// fx cx fy cy, trans_matrix.yaml with T_parent_child, and groundtruth.txt with poses of base_link,
// the robot's, from which those of the colour camera follow.
#include <array>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "ydd/base/yaml_reader.h"
#include "ydd/dataset/picture_files.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/sources/layout.h"
#include "ydd/sources/picture_lists.h"
#include "ydd/sources/pose_files.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

constexpr const char* kColourFrame = "d400_color_optical_frame";

bool looks_like_openloris(const fs::path& path) {
  return has(path, "color.txt") && (has(path, "aligned_depth.txt") || has(path, "depth.txt"));
}

/// The numbers below `key`, a plain list or OpenCV's matrix; empty: there are none.
std::vector<double> numbers_below(const YAML::Node& map, const std::string& key) {
  if (!map.IsMap()) return {};
  YAML::Node node = map[key];
  if (node && node.IsMap()) node.reset(node["data"]);
  if (!node || !node.IsSequence()) return {};
  std::vector<double> out;
  for (const YAML::Node& item : node) {
    double value = 0;
    if (!item.IsScalar() || !YAML::convert<double>::decode(item, value)) return {};
    out.push_back(value);
  }
  return out;
}

/// A whole number; `otherwise` when there is none.
int number_below(const YAML::Node& map, const std::string& key, int otherwise) {
  int value = 0;
  const YAML::Node node = map[key];
  const bool is_there = node && node.IsScalar() && YAML::convert<int>::decode(node, value);
  return is_there ? value : otherwise;
}

Result<Camera> openloris_camera(const fs::path& file) {
  const Result<YAML::Node> root = read_yaml(file, Keys::may_contradict);
  if (!root) return root.error();
  const YAML::Node sensor = root->IsMap() ? (*root)[kColourFrame] : YAML::Node();
  const std::vector<double> k =
      sensor ? numbers_below(sensor, "intrinsics") : std::vector<double>();
  if (k.size() != 4) {
    return Error{fmt::format("{}: has no {} with 'intrinsics' of four numbers", file.string(),
                             kColourFrame)};
  }
  Camera camera{.name = "openloris"};
  camera.width_px = number_below(sensor, "width", 848);
  camera.height_px = number_below(sensor, "height", 480);
  camera.fps = number_below(sensor, "fps", 30);
  camera.fx_px = k[0], camera.cx_px = k[1], camera.fy_px = k[2], camera.cy_px = k[3];
  std::vector<double> d = numbers_below(sensor, "distortion_coefficients");
  d.resize(5);
  camera.k1 = d[0], camera.k2 = d[1], camera.p1 = d[2], camera.p2 = d[3], camera.k3 = d[4];
  camera.depth_scale = 1000;
  if (auto r = check_camera(camera); !r) {
    return Error{fmt::format("{}: {}", file.string(), r.error().message)};
  }
  return camera;
}

Result<SE3> base_to_camera(const fs::path& file) {
  const Result<YAML::Node> root = read_yaml(file, Keys::may_contradict);
  if (!root) return root.error();
  const YAML::Node list = root->IsMap() ? (*root)["trans_matrix"] : YAML::Node();
  if (list && list.IsSequence()) {
    for (const YAML::Node& item : list) {
      const auto is = [&](const char* key, const char* value) {
        return item.IsMap() && item[key] && item[key].IsScalar() && item[key].Scalar() == value;
      };
      if (!is("parent_frame", "base_link") || !is("child_frame", kColourFrame)) continue;
      const std::vector<double> m = numbers_below(item, "matrix");
      if (m.size() != 16) break;
      const Eigen::Matrix4d matrix =
          Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
      const Result<std::optional<SE3>> T = motion_of(matrix, yaml_line(file.string(), item));
      if (!T) return T.error();
      if (*T) return **T;
    }
  }
  return Error{fmt::format("{}: has no matrix from base_link to {}", file.string(), kColourFrame)};
}

Result<StampedPoses> read_openloris_truth(const fs::path& folder) {
  Result<StampedPoses> poses = read_tum_trajectory(folder / "groundtruth.txt");
  if (!poses) return poses;
  const Result<SE3> T_base_camera = base_to_camera(folder / "trans_matrix.yaml");
  if (!T_base_camera) return T_base_camera.error();
  for (StampedPose& pose : *poses) pose.T_world_camera = pose.T_world_camera * *T_base_camera;
  return poses;
}

Result<Recording> open_openloris(const fs::path& folder, const SequenceOptions&) {
  const std::string hint = "OpenLORIS has color.txt and aligned_depth.txt";
  auto colour = read_picture_list(folder, "color.txt", hint);
  if (!colour) return colour.error();
  const bool aligned = has(folder, "aligned_depth.txt");
  if (!aligned) {
    return Error{fmt::format(
        "{}: has depth.txt but no aligned_depth.txt; depth must be registered to colour (extract "
        "the aligned_depth stream as well)",
        folder.string())};
  }
  auto depth = read_picture_list(folder, "aligned_depth.txt", hint);
  if (!depth) return depth.error();
  Recording recording;
  recording.colour = *std::move(colour);
  recording.depth = *std::move(depth);
  recording.pictures = picture_files(recording);
  recording.camera = openloris_camera(folder / "sensors.yaml");
  recording.depth_scale = 1000;
  if (has(folder, "groundtruth.txt")) {
    recording.groundtruth = GroundTruth{folder / "groundtruth.txt", false,
                                        [folder] { return read_openloris_truth(folder); }};
  }
  return recording;
}

}  // namespace

Layout openloris_layout() {
  return {"openloris", "folder with color.txt, aligned_depth.txt and sensors.yaml: OpenLORIS-Scene",
          looks_like_openloris, open_openloris};
}

}  // namespace ydd::sources
