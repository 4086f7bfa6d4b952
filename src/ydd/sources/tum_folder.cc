// SPDX-License-Identifier: Apache-2.0
//
// The layout of the TUM RGB-D benchmark, which Bonn's and our own recordings have as well: rgb.txt
// and depth.txt ("stamp file" lines), the images they name, and often groundtruth.txt.
// https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
#include <fmt/format.h>

#include "ydd/dataset/picture_files.h"
#include "ydd/sources/layout.h"
#include "ydd/sources/picture_lists.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

bool looks_like_tum(const fs::path& path) { return has(path, "rgb.txt") || has(path, "depth.txt"); }

Result<Recording> lists_of(const fs::path& folder) {
  const std::string hint = "a sequence is a folder with rgb.txt and depth.txt (TUM RGB-D layout)";
  auto colour = read_picture_list(folder, "rgb.txt", hint);
  if (!colour) return colour.error();
  auto depth = read_picture_list(folder, "depth.txt", hint);
  if (!depth) return depth.error();
  Recording out;
  out.colour = *std::move(colour);
  out.depth = *std::move(depth);
  return out;
}

Result<Recording> open_tum(const fs::path& folder, const SequenceOptions& options) {
  if (!fs::is_directory(folder)) {
    return Error{fmt::format("{}: is not a folder; give the one that holds rgb.txt and depth.txt",
                             folder.string())};
  }
  Result<Recording> recording = options.associations.empty()
                                    ? lists_of(folder)
                                    : read_associations(folder, options.associations);
  if (!recording) return recording;
  recording->pictures = picture_files(*recording);
  recording->groundtruth = tum_groundtruth(folder / "groundtruth.txt");
  return recording;
}

}  // namespace

Layout tum_layout() {
  return {"tum", "folder with rgb.txt and depth.txt: TUM, Bonn", looks_like_tum, open_tum};
}

}  // namespace ydd::sources
