// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "ydd/dataset/trajectory.h"
#include "ydd/evaluation/error_statistics.h"

namespace ydd {

/// In what the time between the two poses of a pair is measured.
enum class RpeUnit { seconds, frames };

/// How the relative error is computed.
struct RpeOptions {
  double delta = 1.0;               ///< in `unit`; a whole number of frames
  RpeUnit unit = RpeUnit::seconds;  ///< of `delta`
  /// A pose and the truth nearest in time are no pair when they are farther apart.
  double max_difference_s = 0.02;
  /// The benchmark's own rule instead: twice the median spacing of the truth, which takes the
  /// camera's motion between two sparse true poses for an error.
  bool benchmark_matching = false;
  double scale = 1.0;  ///< applied to the estimated motion, for Sim(3) evaluations
};

/// Relative pose error: drift over a fixed interval, no alignment needed.
struct RpeResult {
  std::vector<std::size_t> first_poses;      ///< of each pair, the earlier one of the estimate
  std::vector<double> translation_errors_m;  ///< one per pair of frames
  std::vector<double> rotation_errors_deg;   ///< of the same pairs, degrees
  ErrorStatistics translation_m;             ///< of translation_errors_m, metres over one delta
  ErrorStatistics rotation_deg;              ///< of rotation_errors_deg, degrees over one delta
};

/// Each estimated pose is paired with the one nearest to `delta` later (pairs that would end on the
/// last pose are left out: past it there is nothing to be near to), and each of the two with the
/// ground truth nearest in time, which must be no farther than `max_difference_s`. Empty result
/// when no pair remains.
///
/// Source: J. Sturm et al., A benchmark for the evaluation of RGB-D SLAM systems, IROS 2012,
/// eq. (2)-(4): same pairs, same figures as the benchmark's tool with fixed delta where
/// the truth is dense (100 Hz), and always with `benchmark_matching`.
RpeResult relative_pose_error(const StampedPoses& groundtruth, const StampedPoses& estimate,
                              const RpeOptions& options = {});

}  // namespace ydd
