// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "ydd/base/result.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/simulation/simulator.h"

namespace ydd {

enum class ColourFormat { png, jpeg };
constexpr std::array<std::string_view, 2> choices_of(ColourFormat) { return {"png", "jpeg"}; }

/// How a sequence is written.
struct TumWriterOptions {
  ColourFormat colour_format = ColourFormat::png;
  int jpeg_quality = 92;
  int jobs = 1;       ///< frames at the same time; 0: as many as there are cores
  std::string about;  ///< YAML with the options of the world, kept as simulation.yaml
  /// Called from the calling thread with the number of finished frames; may be empty.
  std::function<void(int)> progress;
};

/// Renders all frames into `folder` in the layout of the TUM RGB-D benchmark: rgb/, depth/ (16-bit
/// PNG, 5000 a metre), mask/ (ids of what moves), rgb.txt, depth.txt, associations.txt,
/// groundtruth.txt, detections.jsonl (exact boxes), camera.yaml, and what sensors of motion say
/// (imu.csv, odometry.txt, sensors.yaml). Written beside it and renamed:
/// the folder is there whole or not at all. Fails if it exists already or cannot be written.
Result<void> write_tum_sequence(const Simulator& simulator, const std::filesystem::path& folder,
                                const TumWriterOptions& options);

/// The exact boxes of a frame as a recorded detector would have written them, score 1.
RecordedFrame to_recorded_frame(const SimulatedFrame& frame, const std::string& colour_file);

}  // namespace ydd
