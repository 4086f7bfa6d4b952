// SPDX-License-Identifier: Apache-2.0
#include "ydd/evaluation/rpe.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <optional>

#include "ydd/dataset/association.h"

namespace ydd {
namespace {

double median_spacing_ns(const std::vector<Timestamp>& stamps) {
  std::vector<double> spacings;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    spacings.push_back(static_cast<double>(stamps[i].ns - stamps[i - 1].ns));
  }
  return error_statistics(spacings).median;
}

/// Index of the estimate `delta` after `i`, clamped to the last.
std::size_t later_index(const std::vector<Timestamp>& stamps, std::size_t i,
                        const RpeOptions& options) {
  if (options.unit == RpeUnit::frames) {
    return std::min(i + static_cast<std::size_t>(std::llround(options.delta)), stamps.size() - 1);
  }
  return nearest_index(stamps, {stamps[i].ns + std::llround(options.delta * 1e9)});
}

SE3 scaled(const SE3& motion, double scale) {
  return {motion.rotation(), scale * motion.translation()};
}

/// Finds the pose that is nearest in time, if it is near enough.
class NearestPose {
 public:
  NearestPose(const StampedPoses& poses, const RpeOptions& options)
      : poses_(poses),
        stamps_(stamps_of(poses)),
        max_distance_ns_(options.benchmark_matching ? 2 * median_spacing_ns(stamps_)
                                                    : 1e9 * options.max_difference_s) {}

  const SE3* find(Timestamp stamp) const {
    if (stamps_.empty()) return nullptr;
    const std::size_t i = nearest_index(stamps_, stamp);
    const auto distance_ns = static_cast<double>(std::abs(stamps_[i].ns - stamp.ns));
    return distance_ns > max_distance_ns_ ? nullptr : &poses_[i].T_world_camera;
  }

 private:
  const StampedPoses& poses_;
  std::vector<Timestamp> stamps_;
  double max_distance_ns_;
};

}  // namespace

RpeResult relative_pose_error(const StampedPoses& groundtruth, const StampedPoses& estimate,
                              const RpeOptions& options) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const NearestPose truth(groundtruth, options);
  const std::vector<Timestamp> stamps = stamps_of(estimate);
  RpeResult result;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const std::size_t j = later_index(stamps, i, options);
    if (j + 1 == estimate.size()) continue;
    const SE3* const truth_i = truth.find(stamps[i]);
    const SE3* const truth_j = truth.find(stamps[j]);
    if (!truth_i || !truth_j) continue;
    const SE3 estimated =
        scaled(estimate[i].T_world_camera.inverse() * estimate[j].T_world_camera, options.scale);
    // Eq. (2) is truth^-1 * estimated; the benchmark's tool looks back in time, from j to i, which
    // puts the factors the other way round: same angle, slightly different length. We follow it.
    const SE3 error = estimated * (truth_i->inverse() * *truth_j).inverse();
    result.first_poses.push_back(i);
    result.translation_errors_m.push_back(error.translation().norm());
    result.rotation_errors_deg.push_back(error.angle_rad() * kDegrees);
  }
  result.translation_m = error_statistics(result.translation_errors_m);
  result.rotation_deg = error_statistics(result.rotation_errors_deg);
  return result;
}

}  // namespace ydd
