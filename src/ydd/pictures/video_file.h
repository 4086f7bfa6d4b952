// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "ydd/base/result.h"
#include "ydd/image/image.h"

namespace ydd {

/// A video that is written picture by picture: H.264 where OpenCV's video back end has an encoder
/// for it (every browser plays it), MPEG-4 otherwise. It appears under its name when it is
/// finished.
///
/// Thread: one.
class VideoFile {
 public:
  /// Fails, in one line, when the folder cannot be written to, when OpenCV came without video, or
  /// when the file's ending is not .mp4.
  static Result<VideoFile> open(const std::filesystem::path& file, int width_px, int height_px,
                                double frames_per_second);
  VideoFile(VideoFile&&) noexcept;
  VideoFile& operator=(VideoFile&&) noexcept;
  /// What is not finished is removed.
  ~VideoFile();

  /// The next picture. @throws std::logic_error if it has another size.
  Result<void> add(const ColourImage& picture);
  Result<void> finish();

 private:
  struct State;
  explicit VideoFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ydd
