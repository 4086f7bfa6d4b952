// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "ydd/dataset/trajectory.h"

namespace ydd {

/// Where the camera was and where it was estimated, both in the estimate's world, metres.
struct TruthPair {
  Eigen::Vector3d estimate;
  Eigen::Vector3d truth;
};

/// Ground truth moved onto the trajectory so far.
struct LiveTruth {
  std::vector<TruthPair> pairs;  ///< in time order
  std::optional<double> rmse_m;  ///< of the distances; none without a pair
};

/// Puts ground truth, which has a world of its own, beside the estimate: aligned over all pairs
/// (as `ydd-slam eval` does) as soon as these fix the rotation, before that by the first pair's
/// poses. Both lists are sorted by time; pairs are less than 20 ms apart.
LiveTruth align_live_truth(const StampedPoses& estimate, const StampedPoses& truth);

}  // namespace ydd
