// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ydd/base/options.h"
#include "ydd/base/result.h"
#include "ydd/base/timestamp.h"
#include "ydd/dataset/pairing.h"
#include "ydd/geometry/camera.h"
#include "ydd/image/rgbd_frame.h"

namespace ydd {

struct SequenceOptions {
  double max_difference_s = 0.02;
  int first_frame = 0;            ///< earlier ones are left out; this one then has index 0
  int max_frames = 0;             ///< as many frames at most; 0: all
  std::string associations = {};  ///< file of "stamp colour stamp depth" lines; empty: pair by time
  std::string depth_offset = "0";  ///< seconds added to depth stamps before pairing, or "auto"

  void describe(OptionTable& table);
};

/// A colour image and the depth image that belongs to it.
struct SequenceEntry {
  Timestamp stamp;  ///< of the colour image
  Timestamp depth_stamp;
  std::filesystem::path colour_file;
  std::filesystem::path depth_file;
};

/// A recording in the layout of the TUM RGB-D benchmark: a folder with rgb.txt and depth.txt
/// ("stamp file" lines), the images they name, and often groundtruth.txt. Immutable; any thread may
/// read.
class Sequence {
 public:
  /// Reads the lists and pairs colour with depth, by time (one-to-one, `associate`) or by the given
  /// file, whose depth images may repeat. Images are not opened yet, except to find the depth
  /// offset "auto".
  static Result<Sequence> open(const std::filesystem::path& folder,
                               const SequenceOptions& options = {});

  std::size_t size() const { return entries_.size(); }
  const SequenceEntry& entry(std::size_t i) const { return entries_.at(i); }
  const std::vector<SequenceEntry>& entries() const { return entries_; }
  const std::filesystem::path& folder() const { return folder_; }
  /// Name of the folder.
  std::string name() const;
  /// groundtruth.txt, if the folder has one.
  const std::optional<std::filesystem::path>& groundtruth_file() const { return groundtruth_file_; }

  /// How pairing by time went; nothing where a file said what belongs together.
  const std::optional<Pairing>& pairing() const { return pairing_; }

  /// Decodes frame `i` (< size()). Both images must have the camera's size.
  Result<RgbdFrame> read(std::size_t i, const Camera& camera) const;

 private:
  std::filesystem::path folder_;
  std::vector<SequenceEntry> entries_;
  std::optional<Pairing> pairing_;
  std::optional<std::filesystem::path> groundtruth_file_;
};

}  // namespace ydd
