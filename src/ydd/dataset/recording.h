// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/base/timestamp.h"
#include "ydd/dataset/association.h"
#include "ydd/dataset/live_stream.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/geometry/camera.h"
#include "ydd/image/image.h"
#include "ydd/reckoning/motion_samples.h"

namespace ydd {

/// A colour picture that is read and found plausible, with no pixel decoded yet: its size is known
/// before memory is taken for it.
struct ColourPicture {
  std::string name;                 ///< as messages call it: a file, or a message of a bag
  int width_px = 0, height_px = 0;  ///< as its header tells
  std::function<Result<ColourImage>()> decode;  ///< reads the pixels; blue green red
};

/// The same of depth.
struct DepthPicture {
  std::string name;                 ///< as messages call it
  int width_px = 0, height_px = 0;  ///< as its header tells
  /// By the camera's depth scale, unless the picture itself is in metres; readings outside the
  /// camera's limits become 0.
  std::function<Result<DepthImage>(const Camera&)> metres;
  /// As counts: those stored, or millimetres of a picture in metres.
  std::function<Result<RawDepthImage>()> counts;
  bool is_metric = false;  ///< it is in metres, whatever the camera's depth scale
};

/// Where the pictures of a recording lie: opens picture `i` of its stream. Immutable; any thread
/// may read.
class PictureStore {
 public:
  PictureStore() = default;
  virtual ~PictureStore() = default;
  PictureStore(const PictureStore&) = delete;
  PictureStore& operator=(const PictureStore&) = delete;

  /// Colour picture `i` of the recording's colour stream, not decoded yet.
  virtual Result<ColourPicture> colour(std::size_t i) const = 0;
  virtual Result<DepthPicture> depth(std::size_t i) const = 0;  ///< The same of its depth stream.
};

/// What the motion sensors of a recording said, read when it is wanted. Immutable.
class MotionStore {
 public:
  MotionStore() = default;
  virtual ~MotionStore() = default;
  MotionStore(const MotionStore&) = delete;
  MotionStore& operator=(const MotionStore&) = delete;

  /// Topics that can be read.
  virtual std::vector<std::string> imu_topics() const = 0;
  /// Topics of wheel odometry that can be read.
  virtual std::vector<std::string> odometry_topics() const = 0;
  /// Of one of these, in the order of time. One line says what cannot be used.
  virtual Result<std::vector<ImuSample>> read_imu(const std::string& topic) const = 0;
  /// Of one of odometry_topics(), in the order of time.
  virtual Result<std::vector<OdometryPose>> read_odometry(const std::string& topic) const = 0;
};

/// One picture of a stream.
struct PictureEntry {
  Timestamp stamp;   ///< when it was taken, by the recording's clock
  std::string name;  ///< as messages call it; the file where it is one
};

/// True poses that a recording comes with.
struct GroundTruth {
  std::filesystem::path place;  ///< file or folder that holds them
  bool is_tum_file = false;     ///< `place` is a trajectory in TUM's format, of the colour camera
  std::function<Result<StampedPoses>()> read;  ///< poses of the colour camera
};

/// What a source finds in a folder or file: two streams of pictures, and what is known of them.
/// A value; copies share the store.
struct Recording {
  std::filesystem::path place;              ///< folder or file
  std::string source;                       ///< which one found it: "tum", "bag", ...
  std::vector<PictureEntry> colour, depth;  ///< stamps of each strictly increasing, none empty
  /// What belongs together (a: colour, b: depth), where the recording says it; then depth stamps
  /// need not increase. Otherwise by time.
  std::optional<std::vector<IndexPair>> pairs;
  /// What the entries' pictures are read from; not null.
  std::shared_ptr<const PictureStore> pictures;
  std::optional<Result<Camera>> camera;  ///< its own, or why that cannot be read; nothing: has none
  std::optional<double> depth_scale;     ///< depth value of one metre, where the format fixes it
  bool depth_is_laid = false;            ///< a run has seen to it already that depth lies on colour
  std::optional<GroundTruth> groundtruth;     ///< true poses, if it has any
  std::shared_ptr<const MotionStore> motion;  ///< null: no such sensors
  /// A camera that is being looked through: then there are no lists, and frames are had from here.
  std::shared_ptr<LiveStream> live;

  /// Name of the folder, or of the file without its ending; that of the source for a camera.
  std::string name() const;
};

}  // namespace ydd
