// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/base/timestamp.h"
#include "ydd/detection/detection.h"
#include "ydd/detection/detector.h"

namespace ydd {

/// A detection with what only a simulator or an annotator knows about it. The extras are written
/// when they are set and kept when they are read; a detector ignores them.
struct RecordedDetection {
  Detection detection;                         ///< class, box and score
  std::string name = {};                       ///< of the instance: "personA"; empty: unknown
  std::optional<std::int64_t> id = {};         ///< of the instance, as in an instance mask
  std::optional<bool> dynamic = {};            ///< moves in this frame
  std::optional<bool> moved_in_sequence = {};  ///< moves in some frame
  std::optional<std::int64_t> pixels = {};     ///< visible pixels
};

/// All detections of one frame: one line of the file.
struct RecordedFrame {
  Timestamp stamp;                    ///< of the colour image
  std::optional<std::int64_t> index;  ///< position in the sequence, key `frame`
  std::string file;                   ///< colour image, relative to the sequence; may be empty
  std::vector<RecordedDetection> detections;  ///< of one picture; may be none
};

/// One line of the file format, JSON without a line break:
///
///     {"timestamp": "1.5", "frame": 0, "file": "rgb/1.5.png", "detections":
///      [{"cls": "person", "score": 0.9, "box": [x0, y0, x1, y1]}, ...]}
///
/// Numbers are written so that they read back bit by bit.
std::string to_json_line(const RecordedFrame& frame);

/// Parses one line. Needs `timestamp` (text or number, seconds), `detections` and in each of them
/// `cls` and `box`; `score` is 1 and `sure` true when absent; keys that are not known are ignored.
/// `source` starts the message of a failure ("detections.jsonl:12").
Result<RecordedFrame> parse_recorded_frame(std::string_view line, std::string_view source);

/// Writes all frames, one a line; readers see the old file or the whole new one.
Result<void> write_recorded_detections(const std::filesystem::path& file,
                                       std::span<const RecordedFrame> frames);

/// The detections of a sequence, to be found by time or by frame.
class DetectionRecording {
 public:
  /// Fails on the first line that cannot be understood, on two lines with the same time stamp, on a
  /// file without frames and on one whose boxes are all fractions of the picture; empty lines are
  /// skipped.
  static Result<DetectionRecording> read(const std::filesystem::path& file);

  /// `frames` in any order. @throws std::logic_error when two have the same stamp.
  explicit DetectionRecording(std::vector<RecordedFrame> frames);

  /// The frame nearest in time (of two equally near the earlier), null when it is further away
  /// than `tolerance_s`. The pointer lives as long as the recording.
  const RecordedFrame* find(Timestamp stamp, double tolerance_s) const;
  /// The first frame with this `index`, or null.
  const RecordedFrame* find_index(std::int64_t index) const;

  /// The classes that occur, in alphabetical order.
  std::vector<std::string> class_names() const;
  /// In the order of time.
  const std::vector<RecordedFrame>& frames() const { return frames_; }

 private:
  std::vector<RecordedFrame> frames_;
};

/// How frames find what was recorded of them.
struct RecordedDetectorOptions {
  double tolerance_s = 0.0005;    ///< largest distance in time between frame and recording
  bool missing_is_empty = false;  ///< a frame that is not recorded has no objects (else an error)
};

/// Replays a recording: runs without any network, and the same input for comparisons.
class RecordedDetector : public Detector {
 public:
  /// `name` stands in messages, usually the file.
  RecordedDetector(DetectionRecording recording, std::string name,
                   RecordedDetectorOptions options = {});

  /// The recorded boxes cut to the frame; those outside it are left out. A box that reaches more
  /// than half a picture beyond it is an error: it was recorded with pictures of another size.
  Result<Detections> detect(const RgbdFrame& frame) override;

 private:
  DetectionRecording recording_;
  std::string name_;
  RecordedDetectorOptions options_;
};

}  // namespace ydd
