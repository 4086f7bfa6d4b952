// SPDX-License-Identifier: Apache-2.0
//
// ICL-NUIM, the "TUM RGB-D compatible PNGs" (https://www.doc.ic.ac.uk/~ahanda/VaFRIC/iclnuim.html):
// associations.txt ("number depth number colour"), rgb/0.png, depth/0.png (5000 counts a metre) and
// livingRoom2.gt.freiburg or traj1.gt.freiburg, whose first column is the number of the frame.
//
// The dataset's page gives fy = -480: its renderer has y upward. The pictures of this archive are
// stored from the top down all the same, so fy is +480 for them, and what has to be turned are the
// poses: reflected in the plane y = 0, on both sides.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/log.h"
#include "ydd/dataset/picture_files.h"
#include "ydd/dataset/text_table.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/sources/frame_numbers.h"
#include "ydd/sources/layout.h"
#include "ydd/sources/picture_lists.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> icl_truth_file(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    if (entry.path().string().ends_with(".gt.freiburg")) found.push_back(entry.path());
  }
  if (found.empty()) return std::nullopt;
  return *std::min_element(found.begin(), found.end());
}

/// Depth stands first in a line, unless somebody has turned that round.
FirstPicture first_of(const fs::path& associations) {
  const Result<TextTable> table = read_text_table(associations);
  const bool is_colour = table && !table->rows.empty() && table->rows.front().fields.size() > 1 &&
                         !table->rows.front().fields[1].starts_with("depth");
  return is_colour ? FirstPicture::colour : FirstPicture::depth;
}

bool looks_like_icl(const fs::path& path) {
  if (icl_truth_file(path)) return true;
  return !has(path, "rgb.txt") && has(path, "associations.txt") &&
         first_of(path / "associations.txt") == FirstPicture::depth;
}

Camera icl_camera() {
  Camera camera{.name = "icl_nuim", .fx_px = 481.20, .fy_px = 480.00};
  camera.cx_px = 319.50, camera.cy_px = 239.50;
  camera.depth_scale = 5000;
  return camera;
}

Timestamp icl_stamp(Timestamp number) { return frame_stamp(number.ns / 1'000'000'000); }

/// Whether stamps count frames instead of seconds.
bool are_numbers(const std::vector<PictureEntry>& pictures) {
  return std::all_of(pictures.begin(), pictures.end(), [](const PictureEntry& picture) {
    return picture.stamp.ns % 1'000'000'000 == 0 && picture.stamp.seconds() < 1e6;
  });
}

/// Diag(1, -1, 1) * T * Diag(1, -1, 1).
SE3 reflected(const SE3& T) {
  const Eigen::Vector3d& t = T.translation();
  const Eigen::Quaterniond& q = T.rotation();
  return {Eigen::Quaterniond(q.w(), -q.x(), q.y(), -q.z()), {t.x(), -t.y(), t.z()}};
}

Result<StampedPoses> read_icl_truth(const fs::path& file, bool by_number) {
  Result<StampedPoses> poses = read_tum_trajectory(file);
  if (!poses) return poses;
  for (StampedPose& pose : *poses) {
    if (by_number) pose.stamp = icl_stamp(pose.stamp);
    pose.T_world_camera = reflected(pose.T_world_camera);
  }
  return poses;
}

Result<Recording> open_icl(const fs::path& folder, const SequenceOptions& options) {
  const fs::path associations =
      options.associations.empty() ? folder / "associations.txt" : fs::path(options.associations);
  Result<Recording> recording = read_associations(folder, associations, first_of(associations));
  if (!recording) return recording;
  const bool by_number = are_numbers(recording->colour);
  if (by_number) {
    for (auto* const pictures : {&recording->colour, &recording->depth}) {
      for (PictureEntry& picture : *pictures) picture.stamp = icl_stamp(picture.stamp);
    }
    tell_frame_rate(folder);
  }
  recording->pictures = picture_files(*recording);
  recording->camera = icl_camera();
  recording->depth_scale = icl_camera().depth_scale;
  if (const auto file = icl_truth_file(folder)) {
    recording->groundtruth = GroundTruth{
        *file, false, [file = *file, by_number] { return read_icl_truth(file, by_number); }};
  }
  return recording;
}

}  // namespace

Layout icl_layout() {
  return {"icl", "folder with associations.txt and *.gt.freiburg: ICL-NUIM", looks_like_icl,
          open_icl};
}

}  // namespace ydd::sources
