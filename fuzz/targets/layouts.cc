// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/base/log.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/sources/source.h"

namespace ydd::fuzz {
namespace {

/// A folder of each layout that has texts of its own; its pictures, which nobody opens, are empty.
struct Layouts {
  Folder icl, openloris, open3d, scenes;

  Layouts() {
    std::filesystem::create_directories(open3d.path() / "color");
    std::filesystem::create_directories(open3d.path() / "depth");
    for (const char* const name : {"0", "1", "2"}) {
      static_cast<void>(open3d.write(std::string("color/") + name + ".jpg", ""));
      static_cast<void>(open3d.write(std::string("depth/") + name + ".png", ""));
      const std::string frame = std::string("frame-00000") + name;
      static_cast<void>(scenes.write(frame + ".color.png", ""));
      static_cast<void>(scenes.write(frame + ".depth.png", ""));
    }
  }
};

void look_at(const Folder& folder, const char* source) {
  SequenceOptions options;
  options.source = source;
  const Result<Sequence> sequence = open_sequence(folder.path(), options);
  expect_one_line(sequence);
  if (!sequence) return;
  expect_one_line(find_camera(sequence->recording()));
  if (!sequence->groundtruth()) return;
  const Result<StampedPoses> truth = sequence->groundtruth()->read();
  expect_one_line(truth);
  if (!truth) return;
  for (const StampedPose& pose : *truth) {
    if (!pose.T_world_camera.translation().allFinite()) broken("a pose that is not finite");
    const double length = pose.T_world_camera.rotation().norm();
    if (!(length > 0.999 && length < 1.001)) broken("a rotation that is none");
  }
}

}  // namespace

// Which layout, then its texts with a zero byte between.
void layouts(std::string_view input) {
  static const Layouts layouts;
  log::set_level(log::Level::off);
  Pieces pieces(input);
  switch (pieces.byte() % 4) {
    case 0:
      layouts.icl.write("associations.txt", pieces.until('\0'));
      layouts.icl.write("traj0.gt.freiburg", pieces.until('\0'));
      return look_at(layouts.icl, "icl");
    case 1:
      for (const char* const name : {"color.txt", "aligned_depth.txt", "sensors.yaml",
                                     "trans_matrix.yaml", "groundtruth.txt"}) {
        layouts.openloris.write(name, pieces.until('\0'));
      }
      return look_at(layouts.openloris, "openloris");
    case 2:
      layouts.open3d.write("trajectory.log", pieces.until('\0'));
      layouts.open3d.write("camera_intrinsic.json", pieces.until('\0'));
      return look_at(layouts.open3d, "open3d");
    default:
      for (const char* const name : {"frame-000000.pose.txt", "frame-000002.pose.txt"}) {
        layouts.scenes.write(name, pieces.until('\0'));
      }
      return look_at(layouts.scenes, "7scenes");
  }
}

}  // namespace ydd::fuzz
