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
#include "ydd/dataset/depth_shift.h"
#include "ydd/dataset/pairing.h"
#include "ydd/dataset/recording.h"
#include "ydd/geometry/camera.h"
#include "ydd/image/rgbd_frame.h"

namespace ydd {

/// How a recording is read and paired.
struct SequenceOptions {
  double max_difference_s = 0.02;
  int first_frame = 0;               ///< earlier ones are left out; this one then has index 0
  int max_frames = 0;                ///< as many frames at most; 0: all
  std::string associations = {};     ///< file of "stamp colour stamp depth" lines; empty: as the
                                     ///< recording says, else by time
  std::string depth_offset = "0";    ///< seconds added to depth stamps before pairing, or "auto"
  std::string depth_shift = "auto";  ///< "RIGHT,DOWN" in px that depth is off, or "auto"
  std::string source = {};           ///< name of the source; empty: told by what lies there
  std::string topic_colour = {};     ///< of a bag; empty: told by encodings and names
  std::string topic_depth = {};
  std::string topic_camera_info = {};
  std::string camera_mode = {};  ///< of a camera, "640x480@30"; empty: chosen

  void describe(OptionTable& table);
};

/// A colour picture and the depth picture that belongs to it.
struct SequenceEntry {
  Timestamp stamp;                      ///< of the colour picture
  Timestamp depth_stamp;                ///< of the depth picture that goes with it
  std::size_t colour = 0, depth = 0;    ///< which of the recording's
  std::string colour_name, depth_name;  ///< as messages call them; files where they are
};

/// The frames of a recording: its pictures, paired. Immutable; any thread may read.
class Sequence {
 public:
  /// Pairs colour with depth, as the recording says or by time (one-to-one, `associate`). Pictures
  /// are not opened, except to find what is "auto".
  static Result<Sequence> of(Recording recording, const SequenceOptions& options = {});

  std::size_t size() const { return entries_.size(); }  ///< Number of pairs of colour and depth.
  /// Which pictures frame `i` is made of. @throws std::out_of_range.
  const SequenceEntry& entry(std::size_t i) const { return entries_.at(i); }
  /// All of them, in the order of time.
  const std::vector<SequenceEntry>& entries() const { return entries_; }

  /// Whether this is a camera: then no frame is known beforehand nor can be read again, size() is
  /// 0, and `recording().live` gives what comes.
  bool is_live() const { return recording_.live != nullptr; }
  const SequenceOptions& options() const { return options_; }  ///< By which pairs were made.

  /// The folder or file that was opened.
  const std::filesystem::path& place() const { return recording_.place; }
  std::string name() const { return recording_.name(); }     ///< Of the folder or file.
  const Recording& recording() const { return recording_; }  ///< What it was made of.
  /// True poses, where the recording has any.
  const std::optional<GroundTruth>& groundtruth() const { return recording_.groundtruth; }

  /// How pairing by time went; nothing where the recording said what belongs together.
  const std::optional<Pairing>& pairing() const { return pairing_; }

  /// How far depth lies off colour, as told or (`auto`) as the pictures show it without doubt.
  DepthShift depth_shift() const { return depth_shift_; }

  /// Decodes frame `i` (< size()). Both images must have the camera's size. Depth is moved back by
  /// the depth shift.
  Result<RgbdFrame> read(std::size_t i, const Camera& camera) const;
  /// The colour image of frame `i` alone, of whatever size.
  Result<ColourImage> read_colour(std::size_t i) const;
  /// The depth image of frame `i` as counts (DepthPicture::counts).
  Result<RawDepthImage> read_depth_counts(std::size_t i) const;

 private:
  Result<DepthShift> find_depth_shift(const std::string& asked) const;

  Recording recording_;
  SequenceOptions options_;
  std::vector<SequenceEntry> entries_;
  std::optional<Pairing> pairing_;
  DepthShift depth_shift_;
};

}  // namespace ydd
