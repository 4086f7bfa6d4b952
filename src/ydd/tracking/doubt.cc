// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracking/doubt.h"

namespace ydd {

void DoubtOptions::describe(OptionTable& t) {
  t.add("enabled", enabled, "doubt depth that contradicts the map, and motion that no body makes");
  t.add("depth_factor", depth_factor, {1.0, 100.0}, "",
        "depth is doubted when it is so many times farther off the map than usual, ...");
  t.add("depth_floor_per_m", depth_floor_per_m, {0.0, 1.0}, "1/m",
        "... and farther than this share of the squared distance");
  t.add("longest_s", longest_s, {0.0, 3600.0}, "s", "doubt that lasts longer is given up");
  t.add("max_speed_m_s", max_speed_m_s, {0.1, 1000.0}, "m/s", "no camera is carried faster");
  t.add("max_turn_rad_s", max_turn_rad_s, {0.1, 1000.0}, "rad/s", "nor turned");
}

bool Doubt::raise(const std::string& reason, Timestamp now) {
  const bool first = !pending();
  if (first) since_ = now;
  believed_since_.reset();
  reason_ = reason;
  return first;
}

bool Doubt::settle(Timestamp now) {
  constexpr double kSettle_s = 0.5;
  if (!pending()) return true;
  if (!believed_since_) believed_since_ = now;
  if (seconds_between(*believed_since_, now) < kSettle_s) return false;
  since_.reset();
  believed_since_.reset();
  reason_.clear();
  return true;
}

bool Doubt::lasts_too_long(Timestamp now) const {
  return pending() && seconds_between(*since_, now) > longest_s_;
}

bool is_motion_of_a_body(const SE3& motion, double interval_s, const DoubtOptions& limits) {
  constexpr double kSlack_m = 0.1;  // of a map that was corrected, of a pose that was rough
  constexpr double kSlack_rad = 0.2;
  return motion.translation().norm() <= kSlack_m + limits.max_speed_m_s * interval_s &&
         motion.angle_rad() <= kSlack_rad + limits.max_turn_rad_s * interval_s;
}

}  // namespace ydd
