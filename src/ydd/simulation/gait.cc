// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/gait.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ydd::sim {

SE3 on_floor(const Eigen::Vector2d& place_m, double heading_rad) {
  // A person's forward is y.
  return {Eigen::Quaterniond(
              Eigen::AngleAxisd(heading_rad - 0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ())),
          Eigen::Vector3d(place_m.x(), place_m.y(), 0)};
}

PersonPose stride(const PersonShape& shape, double distance_m, double liveliness) {
  const double swing = 0.33 * liveliness;
  // A cycle is two steps, each as long as the legs open: the standing foot stays where it is.
  const double leg = (shape.thigh + shape.shin) * shape.scale;
  const double phase = 2.0 * std::numbers::pi * distance_m / (4.0 * leg * std::sin(0.33));
  PersonPose pose;
  for (int side = 0; side < 2; ++side) {
    const double p = phase + (side == 0 ? 0.0 : std::numbers::pi);
    const double lift = std::max(0.0, std::cos(p + 0.4));
    pose.legs[side].hip = swing * std::sin(p) + 0.1 * liveliness * lift;
    pose.legs[side].knee = 0.07 + 0.85 * liveliness * lift * lift;
    pose.legs[side].ankle = 0.75 * (pose.legs[side].knee - pose.legs[side].hip);
    pose.arms[side].shoulder = -0.9 * swing * std::sin(p);
    pose.arms[side].elbow = 0.3 + 0.25 * swing * std::sin(p + 0.5);
  }
  pose.twist = 0.12 * swing / 0.33 * std::sin(phase);
  return pose;
}

}  // namespace ydd::sim
