// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/studies/point_quality.h"
#include "ydd/system/system_options.h"

namespace ydd {

/// Decisions about the points of a whole sequence, held against what really moves.
struct PointDecisions {
  PointQuality quality;
  std::vector<double> judge_ms, extract_ms;  ///< processor time, one entry a frame
};

/// What the whole system decides about the points of a sequence that has a folder `mask` (the
/// instance of what moves at every pixel, 0: nothing), with recorded boxes; without a file there
/// are none. With a latency above 0 the boxes come from a detector that needs so many frames, and
/// are carried on meanwhile.
Result<PointDecisions> decide_points(const std::filesystem::path& folder,
                                     const std::filesystem::path& detections_file,
                                     const SystemOptions& options, int latency_frames);

}  // namespace ydd
