// SPDX-License-Identifier: Apache-2.0
#include "ydd/live/live_truth.h"

#include <algorithm>
#include <cmath>

#include "ydd/geometry/alignment.h"

namespace ydd {
namespace {

constexpr std::int64_t kFarthest_ns = 20'000'000;
/// A path within a smaller ball than this says little about rotation.
constexpr double kLeastPath_m = 0.25;

struct PosePair {
  SE3 T_estimate_camera;
  SE3 T_truth_camera;
};

/// For each estimate the truth nearest in time. (One truth may serve two estimates: this is for
/// looking at; `ydd-slam eval` associates strictly.)
std::vector<PosePair> pair_up(const StampedPoses& estimate, const StampedPoses& truth) {
  std::vector<PosePair> pairs;
  for (const StampedPose& pose : estimate) {
    auto next = std::lower_bound(
        truth.begin(), truth.end(), pose.stamp,
        [](const StampedPose& candidate, Timestamp stamp) { return candidate.stamp < stamp; });
    const auto distance_ns = [&](auto at) { return std::abs(at->stamp.ns - pose.stamp.ns); };
    if (next != truth.begin() &&
        (next == truth.end() || distance_ns(std::prev(next)) < distance_ns(next))) {
      --next;
    }
    if (next == truth.end() || distance_ns(next) > kFarthest_ns) continue;
    pairs.push_back({pose.T_world_camera, next->T_world_camera});
  }
  return pairs;
}

SE3 alignment_of(const std::vector<PosePair>& pairs) {
  std::vector<Eigen::Vector3d> estimate;
  std::vector<Eigen::Vector3d> truth;
  double reach_m = 0;
  for (const PosePair& pair : pairs) {
    estimate.push_back(pair.T_estimate_camera.translation());
    truth.push_back(pair.T_truth_camera.translation());
    reach_m = std::max(reach_m, (truth.back() - truth.front()).norm());
  }
  const auto aligned = align_points(truth, estimate);
  if (aligned && aligned->unique && reach_m > kLeastPath_m) return aligned->T_target_source;
  return pairs.front().T_estimate_camera * pairs.front().T_truth_camera.inverse();
}

}  // namespace

LiveTruth align_live_truth(const StampedPoses& estimate, const StampedPoses& truth) {
  const std::vector<PosePair> pairs = pair_up(estimate, truth);
  LiveTruth out;
  if (pairs.empty()) return out;
  const SE3 T_estimate_truth = alignment_of(pairs);
  double sum_m2 = 0;
  for (const PosePair& pair : pairs) {
    out.pairs.push_back({pair.T_estimate_camera.translation(),
                         T_estimate_truth * pair.T_truth_camera.translation()});
    sum_m2 += (out.pairs.back().estimate - out.pairs.back().truth).squaredNorm();
  }
  out.rmse_m = std::sqrt(sum_m2 / static_cast<double>(pairs.size()));
  return out;
}

}  // namespace ydd
