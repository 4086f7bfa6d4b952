// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ydd/base/result.h"
#include "ydd/dataset/association.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/evaluation/error_statistics.h"
#include "ydd/geometry/alignment.h"

namespace ydd {

/// How the absolute error is computed.
struct AteOptions {
  double max_difference_s = 0.02;                ///< poses farther apart in time are no pair
  AlignmentScale scale = AlignmentScale::fixed;  ///< whether the estimate may be scaled to fit
};

/// Absolute trajectory error: distances that remain after the best alignment of the whole
/// trajectory.
struct AteResult {
  std::vector<IndexPair> pairs;  ///< a: ground truth, b: estimate
  Alignment alignment;           ///< estimate to ground truth
  std::vector<double> errors_m;  ///< one per pair
  ErrorStatistics statistics_m;  ///< of errors_m, metres
};

/// Fewer than three pairs are an error, because they fix no alignment; its message names no file.
///
/// Source: J. Sturm et al., A benchmark for the evaluation of RGB-D SLAM systems, IROS 2012,
/// sec. VI-B: same association, same optimum, same figures as the benchmark's tool.
Result<AteResult> absolute_trajectory_error(const StampedPoses& groundtruth,
                                            const StampedPoses& estimate,
                                            const AteOptions& options = {});

}  // namespace ydd
