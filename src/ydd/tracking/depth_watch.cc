// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracking/depth_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ydd {
namespace {

constexpr std::size_t kFewest = 25;  ///< points with depth that a judgement needs
constexpr double kForget = 0.05;     ///< share of the newest frame in what is usual
constexpr int kToLearn = 10;         ///< frames that tell what is usual
constexpr double kNoSensor_per_m = 0.05;

}  // namespace

DepthWatch::Verdict DepthWatch::check(const Camera& camera, const PyramidScales& scales,
                                      const Features& features, const SE3& T_camera_world,
                                      const std::vector<PointMatch>& matches,
                                      const PoseOnlyOptions& pose_options, bool in_doubt) const {
  Verdict verdict;
  if (!options_.enabled) return verdict;
  PoseFromMatches colour = pose_from_matches(camera, scales, features, T_camera_world, matches,
                                             pose_options, /*use_depth=*/false);
  std::vector<double> off_per_m;
  for (const PointMatch& m : colour.inliers) {
    const double measured_m = features.depth_m[static_cast<std::size_t>(m.keypoint)];
    const double expected_m = (colour.T_camera_world * m.p_world).z();
    if (measured_m <= 0 || expected_m <= 0) continue;
    off_per_m.push_back(std::abs(measured_m - expected_m) / (expected_m * expected_m));
  }
  if (off_per_m.size() < kFewest) return verdict;
  const auto middle = off_per_m.begin() + static_cast<std::ptrdiff_t>(off_per_m.size() / 2);
  std::nth_element(off_per_m.begin(), middle, off_per_m.end());
  verdict.off_per_m = *middle;
  // Before it is known what is usual, only what no sensor gives is doubted.
  const double limit_per_m = learnt_ < kToLearn ? kNoSensor_per_m
                                                : std::max(options_.depth_floor_per_m,
                                                           options_.depth_factor * usual_per_m_);
  constexpr double kHysteresis = 0.6;
  verdict.doubtful = verdict.off_per_m > (in_doubt ? kHysteresis : 1.0) * limit_per_m;
  verdict.colour = std::move(colour);
  return verdict;
}

void DepthWatch::learn(const Verdict& verdict) {
  if (verdict.colour.inliers.empty()) return;
  ++learnt_;
  const double share = std::max(kForget, 1.0 / learnt_);  // the mean, until there are enough
  usual_per_m_ += share * (verdict.off_per_m - usual_per_m_);
}

TrackedFrame colour_only(TrackedFrame frame) {
  Features without = frame.features();
  std::fill(without.depth_m.begin(), without.depth_m.end(), 0.0F);
  std::fill(without.right_px.begin(), without.right_px.end(), -1.0F);
  frame.shared_features = std::make_shared<const Features>(std::move(without));
  return frame;
}

}  // namespace ydd
