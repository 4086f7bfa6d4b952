// SPDX-License-Identifier: Apache-2.0
#include "ydd/evaluation/ate.h"

#include <cmath>

#include <fmt/format.h>

namespace ydd {
namespace {

constexpr std::size_t kMinPairs = 3;

Error too_few_pairs(std::size_t pairs, const StampedPoses& truth, const StampedPoses& estimate,
                    double max_difference_s) {
  if (truth.empty() || estimate.empty()) return Error{"an empty trajectory cannot be evaluated"};
  return Error{fmt::format(
      "only {} of {} poses have ground truth within {} s, at least {} are needed (the trajectory "
      "covers {:.3f} to {:.3f} s, ground truth {:.3f} to {:.3f} s)",
      pairs, estimate.size(), max_difference_s, kMinPairs, estimate.front().stamp.seconds(),
      estimate.back().stamp.seconds(), truth.front().stamp.seconds(),
      truth.back().stamp.seconds())};
}

}  // namespace

Result<AteResult> absolute_trajectory_error(const StampedPoses& groundtruth,
                                            const StampedPoses& estimate,
                                            const AteOptions& options) {
  AteResult result;
  result.pairs = associate(stamps_of(groundtruth), stamps_of(estimate), options.max_difference_s);
  if (result.pairs.size() < kMinPairs) {
    return too_few_pairs(result.pairs.size(), groundtruth, estimate, options.max_difference_s);
  }
  std::vector<Eigen::Vector3d> p_truth;
  std::vector<Eigen::Vector3d> p_estimate;
  for (const auto& [truth, estimated] : result.pairs) {
    p_truth.push_back(groundtruth[truth].T_world_camera.translation());
    p_estimate.push_back(estimate[estimated].T_world_camera.translation());
  }
  result.alignment = align_points(p_estimate, p_truth, options.scale).value();
  for (std::size_t i = 0; i < p_truth.size(); ++i) {
    result.errors_m.push_back((result.alignment * p_estimate[i] - p_truth[i]).norm());
  }
  result.statistics_m = error_statistics(result.errors_m);
  return result;
}

}  // namespace ydd
