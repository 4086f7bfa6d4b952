// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "ydd/detection/object_catalogue.h"

namespace ydd {

/// An interval of depths along the optical axis, both ends included. A depth of 0 (no reading) is
/// in no range.
struct DepthRange {
  float min_m = 0;  ///< nearest depth in it, metres
  float max_m = 0;  ///< farthest depth in it, metres
  /// Never true of 0, no reading.
  bool contains(float depth_m) const {
    return depth_m > 0.0F && depth_m >= min_m && depth_m <= max_m;
  }
  friend bool operator==(const DepthRange&, const DepthRange&) = default;
};

/// The smallest interval that contains both.
inline DepthRange joined(const DepthRange& a, const DepthRange& b) {
  return {std::min(a.min_m, b.min_m), std::max(a.max_m, b.max_m)};
}

/// `[D - allowance * d, D + d]`: the range of a thing of depth extent d whose approximate minimum
/// depth is D; also of automatic and of moved objects (article, equations 5 and 6).
DepthRange object_range(float depth_m, double extent_m, double front_allowance);

/// The measured depths of a body's parts; none: not detected, or without any reading.
struct BodyDepths {
  std::optional<float> person_m;         ///< of the body, metres
  std::optional<float> head_m;           ///< of the head that was matched to it, metres
  std::optional<float> nearest_hand_m;   ///< of its hand closer to the camera, metres
  std::optional<float> farthest_hand_m;  ///< of its hand farther from the camera, metres
};

/// `[Dhead + head/2 - half_hand, Dhead + head/2 + half_hand]` (article, equation 4).
DepthRange head_range(float head_depth_m, const DepthExtents& extents);
/// `[D1 - allowance * hand, D2 + hand]`, D1 the nearer hand.
DepthRange hands_range(float nearest_m, float farthest_m, const DepthExtents& extents,
                       double front_allowance);
/// `[Dperson - allowance * 2 half_hand, Dperson + 2 half_hand]`.
DepthRange person_range(float person_depth_m, const DepthExtents& extents, double front_allowance);

/// The final depth range of a human body, at most two of the ranges joined (article, figure 7):
/// head and hands; head (with the person's when the person's depth lies outside it); person and
/// hands; person. Nothing when the depth that is needed has failed.
std::optional<DepthRange> body_range(const BodyDepths& depths, const DepthExtents& extents,
                                     double front_allowance);

}  // namespace ydd
