// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/visitors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "ydd/simulation/gait.h"

namespace ydd::sim {
namespace {

using Eigen::Vector2d;

constexpr double kFacesCamera_rad = -0.5 * std::numbers::pi;

/// A straight walk between two times; nobody moves before and after it.
struct StraightWay {
  Vector2d from_m;
  Vector2d to_m;
  double begin_s = 0;
  double end_s = 0;
  double turn_s = 0.7;  ///< time for the turn between the walk and the camera
  bool leaves = false;  ///< faces the camera before the walk, otherwise after it
};

/// From 0 to 1 with neither end jerking.
double ease(double part) {
  const double p = std::clamp(part, 0.0, 1.0);
  return p * p * (3.0 - 2.0 * p);
}

PersonPose visit(const PersonShape& shape, const StraightWay& way, double t) {
  const Vector2d whole = way.to_m - way.from_m;
  const double length_m = whole.norm();
  const double part = std::clamp((t - way.begin_s) / (way.end_s - way.begin_s), 0.0, 1.0);
  const double speed = 6.0 * part * (1.0 - part) * length_m / (way.end_s - way.begin_s);
  PersonPose pose = stride(shape, length_m * ease(part), std::min(1.0, speed / 0.5));
  // On the way from the camera or on the way to it, by the shorter turn.
  const double ahead_rad = std::atan2(whole.y(), whole.x());
  const double turn_rad = std::remainder(ahead_rad - kFacesCamera_rad, 2.0 * std::numbers::pi);
  const double turned =
      way.leaves ? ease((t - way.begin_s) / way.turn_s) : ease((way.end_s - t) / way.turn_s);
  pose.T_world_person =
      on_floor(way.from_m + ease(part) * whole, kFacesCamera_rad + turned * turn_rad);
  return pose;
}

void add_visitor(SceneBuilder& builder, int number, const StraightWay& way) {
  add_person(builder, number, 1.06,
             [way](const PersonShape& shape, double t) { return visit(shape, way, t); });
}

}  // namespace

void add_leaver(SceneBuilder& builder, int number) {
  add_visitor(builder, number,
              {{2.6, 2.9}, {1.15, 1.45}, kLeaverStands_s, kLeaverStands_s + 2.5, 0.7, true});
}

void add_comer(SceneBuilder& builder, int number) {
  add_visitor(builder, number, {{4.45, 1.7}, {3.25, 2.95}, 0.0, kComerArrives_s, 0.7, false});
}

}  // namespace ydd::sim
