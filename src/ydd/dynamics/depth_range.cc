// SPDX-License-Identifier: Apache-2.0
#include "ydd/dynamics/depth_range.h"

namespace ydd {

// The measured depth is an approximate minimum, not the minimum: hence the allowance in front.
// Erratum: the article prints the hand's lower end with a plus sign.

DepthRange object_range(float depth_m, double extent_m, double front_allowance) {
  return {static_cast<float>(depth_m - front_allowance * extent_m),
          static_cast<float>(depth_m + extent_m)};
}

DepthRange head_range(float head_depth_m, const DepthExtents& extents) {
  const double centre_m = head_depth_m + extents.head_m / 2;
  return {static_cast<float>(centre_m - extents.half_hand_m),
          static_cast<float>(centre_m + extents.half_hand_m)};
}

DepthRange hands_range(float nearest_m, float farthest_m, const DepthExtents& extents,
                       double front_allowance) {
  return joined(object_range(nearest_m, extents.hand_m, front_allowance),
                object_range(farthest_m, extents.hand_m, front_allowance));
}

DepthRange person_range(float person_depth_m, const DepthExtents& extents, double front_allowance) {
  return object_range(person_depth_m, 2 * extents.half_hand_m, front_allowance);
}

std::optional<DepthRange> body_range(const BodyDepths& depths, const DepthExtents& extents,
                                     double front_allowance) {
  std::optional<DepthRange> hands;
  if (depths.nearest_hand_m && depths.farthest_hand_m) {
    hands = hands_range(*depths.nearest_hand_m, *depths.farthest_hand_m, extents, front_allowance);
  }
  std::optional<DepthRange> person;
  if (depths.person_m) person = person_range(*depths.person_m, extents, front_allowance);
  if (depths.head_m) {
    const DepthRange head = head_range(*depths.head_m, extents);
    if (hands) return joined(head, *hands);
    const bool outside = depths.person_m && !head.contains(*depths.person_m);
    return outside ? joined(head, *person) : head;
  }
  if (!person) return std::nullopt;
  return hands ? joined(*person, *hands) : *person;
}

}  // namespace ydd
